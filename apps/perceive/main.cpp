#include "apps/perceive/commands.h"

int main(int argc, char** argv) {
  loci::apps::Program program("loci-perceive", "Run perception pipelines over recordings");
  program.add(loci::apps::annotate_command());
  program.add(loci::apps::info_command());
  program.add(loci::apps::convert_command());
  program.add(loci::apps::types_command());
  program.add(loci::apps::cas_command());
  program.add(loci::apps::run_command());
  program.add(loci::apps::list_command());
  program.add(loci::apps::describe_command());
  program.add(loci::apps::index_command());
  program.add(loci::apps::read_command());
  program.add(loci::apps::recognise_command());
  program.add(loci::apps::search_command());
  program.add(loci::apps::serve_command());
  program.add(loci::apps::surface_command());
  program.add(loci::apps::train_command());
  return program.run(argc, argv);
}
