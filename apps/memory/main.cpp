#include "apps/memory/commands.h"

int main(int argc, char** argv) {
  loci::apps::Program program("loci-memory", "Asks and keeps the spatio-temporal memory.");
  program.add(loci::apps::resolve_command());
  program.add(loci::apps::where_command());
  program.add(loci::apps::history_command());
  program.add(loci::apps::on_command());
  program.add(loci::apps::in_command());
  program.add(loci::apps::was_command());
  program.add(loci::apps::changes_command());
  program.add(loci::apps::objects_command());
  program.add(loci::apps::scenes_command());
  program.add(loci::apps::timeline_command());
  program.add(loci::apps::usual_command());
  program.add(loci::apps::kept_command());
  program.add(loci::apps::task_command());
  program.add(loci::apps::near_command());
  program.add(loci::apps::together_command());
  program.add(loci::apps::missing_command());
  program.add(loci::apps::kind_command());
  program.add(loci::apps::lifecycle_command());
  program.add(loci::apps::next_look_command());
  program.add(loci::apps::like_command());
  program.add(loci::apps::about_command());
  program.add(loci::apps::room_command());
  program.add(loci::apps::opens_command());
  program.add(loci::apps::ask_command());
  program.add(loci::apps::fact_command());
  program.add(loci::apps::taxonomy_command());
  program.add(loci::apps::edit_command());
  program.add(loci::apps::verify_command());
  program.add(loci::apps::stat_command());
  program.add(loci::apps::export_command());
  program.add(loci::apps::model_command());
  program.add(loci::apps::forget_command());
  program.add(loci::apps::merge_command());
  program.add(loci::apps::retain_command());
  program.add(loci::apps::ingest_command());
  program.add(loci::apps::report_command());
  program.add(loci::apps::why_command());
  program.add(loci::apps::reason_command());
  program.add(loci::apps::catalogue_command());
  return program.run(argc, argv);
}
