#pragma once

#include "apps/cli/program.h"

namespace loci::apps {

Command resolve_command();
Command where_command();
Command history_command();
Command on_command();
Command in_command();
Command was_command();
Command changes_command();
Command objects_command();
Command scenes_command();
Command timeline_command();
Command usual_command();
Command kept_command();
Command task_command();
Command near_command();
Command together_command();
Command missing_command();
Command kind_command();
Command lifecycle_command();
Command next_look_command();
Command like_command();
Command about_command();
Command room_command();
Command opens_command();
Command catalogue_command();
Command ask_command();
Command fact_command();
Command taxonomy_command();
Command edit_command();
Command verify_command();
Command stat_command();
Command export_command();
Command model_command();
Command forget_command();
Command merge_command();
Command retain_command();

Command ingest_command();
Command report_command();

Command why_command();
Command reason_command();

}  // namespace loci::apps
