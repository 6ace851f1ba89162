#pragma once

#include "apps/cli/program.h"

namespace loci {

Command info_command();
Command types_command();

}  // namespace loci
