#pragma once

#include "apps/cli/program.h"

namespace loci {

Command fuse_command();

}  // namespace loci
