#include "apps/memory/commands.h"

int main(int argc, char** argv) {
  loci::Program program("loci-memory", "Asks and keeps the spatio-temporal memory.");
  program.add(loci::resolve_command());
  program.add(loci::where_command());
  program.add(loci::history_command());
  program.add(loci::on_command());
  program.add(loci::in_command());
  program.add(loci::was_command());
  program.add(loci::changes_command());
  program.add(loci::objects_command());
  program.add(loci::scenes_command());
  program.add(loci::timeline_command());
  program.add(loci::usual_command());
  program.add(loci::kept_command());
  program.add(loci::task_command());
  program.add(loci::near_command());
  program.add(loci::together_command());
  program.add(loci::missing_command());
  program.add(loci::kind_command());
  program.add(loci::lifecycle_command());
  program.add(loci::next_look_command());
  program.add(loci::like_command());
  program.add(loci::about_command());
  program.add(loci::room_command());
  program.add(loci::opens_command());
  program.add(loci::ask_command());
  program.add(loci::fact_command());
  program.add(loci::taxonomy_command());
  program.add(loci::edit_command());
  program.add(loci::verify_command());
  program.add(loci::stat_command());
  program.add(loci::export_command());
  program.add(loci::model_command());
  program.add(loci::forget_command());
  program.add(loci::merge_command());
  program.add(loci::retain_command());
  program.add(loci::ingest_command());
  program.add(loci::report_command());
  program.add(loci::why_command());
  program.add(loci::reason_command());
  program.add(loci::catalogue_command());
  return program.run(argc, argv);
}
