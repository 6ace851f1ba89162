#pragma once

#include "apps/cli/program.h"

namespace loci::apps {

Command annotate_command();
Command cas_command();
Command convert_command();
Command describe_command();
Command index_command();
Command info_command();
Command list_command();
Command read_command();
Command recognise_command();
Command run_command();
Command search_command();
Command serve_command();
Command surface_command();
Command train_command();
Command types_command();

}  // namespace loci::apps
