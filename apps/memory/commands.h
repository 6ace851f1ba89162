#pragma once

#include "apps/cli/program.h"

namespace loci::apps {

/// The questions of memory/questions, `ask`, `why` and `questions`.
void add_question_commands(Program& program);

Command resolve_command();
Command catalogue_command();
Command fact_command();
Command taxonomy_command();
Command teach_command();
Command map_command();
Command edit_command();
Command verify_command();
Command backup_command();
Command restore_command();
Command stat_command();
Command time_zone_command();
Command export_command();
Command model_command();
Command forget_command();
Command merge_command();
Command retain_command();

Command ingest_command();
Command serve_command();
Command watch_command();
Command push_command();
Command grant_command();
Command unify_command();
Command report_command();

Command reason_command();

}  // namespace loci::apps
