#pragma once

#include "apps/cli/program.h"

namespace loci::apps {

Command articulate_command();
Command check_command();
Command compare_command();
Command explore_command();
Command export_command();
Command fuse_command();
Command interpret_command();
Command register_command();
Command next_view_command();
Command track_command();
Command update_command();

}  // namespace loci::apps
