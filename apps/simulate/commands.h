#pragma once

#include "apps/cli/program.h"

namespace loci {

Command record_command();

}  // namespace loci
