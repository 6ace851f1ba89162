#pragma once

#include "apps/cli/program.h"

namespace loci {

Command changes_command();

}  // namespace loci
