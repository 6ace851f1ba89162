#pragma once

#include "apps/cli/program.h"

namespace loci {

Command resolve_command();

}  // namespace loci
