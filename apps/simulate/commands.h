#pragma once

#include "apps/cli/program.h"

namespace loci {

Command record_command();
Command scan_command();

}  // namespace loci
