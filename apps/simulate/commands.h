#pragma once

#include "apps/cli/program.h"

namespace loci::apps {

Command kitchen_command();
Command record_command();
Command scan_command();

}  // namespace loci::apps
