#pragma once

#include "apps/cli/program.h"

namespace loci {

// What people say, and the words for it.
Command fact_command();
Command taxonomy_command();

}  // namespace loci
