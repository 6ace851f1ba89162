#include "apps/memory/commands.h"

int main(int argc, char** argv) {
  using namespace loci::apps;
  Program program("loci-memory", "Query and maintain a spatio-temporal object memory");
  const auto add = [&](const char* group, std::vector<Command> commands) {
    for (Command& command : commands) {
      command.group = group;
      program.add(std::move(command));
    }
  };
  add_question_commands(program);
  add("Inspect", {stat_command(), report_command(), watch_command()});
  add("Correct", {edit_command(), fact_command(), teach_command(), taxonomy_command()});
  add("Maintain", {reason_command(), resolve_command(), verify_command(), backup_command(), restore_command(),
                   retain_command(), forget_command(), merge_command(), time_zone_command()});
  add("Exchange", {ingest_command(), map_command(), export_command(), catalogue_command(), model_command(),
                   serve_command()});
  add("Share", {push_command(), grant_command(), unify_command()});
  return program.run(argc, argv);
}
