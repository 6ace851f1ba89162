#include "apps/memory/commands.h"

int main(int argc, char** argv) {
  loci::apps::Program program("loci-memory", "Asks and keeps the spatio-temporal memory.");
  program.add(loci::apps::resolve_command());
  loci::apps::add_question_commands(program);
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
  program.add(loci::apps::reason_command());
  program.add(loci::apps::catalogue_command());
  return program.run(argc, argv);
}
