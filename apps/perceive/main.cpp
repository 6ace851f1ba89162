#include "apps/perceive/commands.h"

int main(int argc, char** argv) {
  loci::Program program("loci-perceive", "Runs perception experts over recordings.");
  program.add(loci::annotate_command());
  program.add(loci::info_command());
  program.add(loci::types_command());
  program.add(loci::cas_command());
  program.add(loci::run_command());
  program.add(loci::list_command());
  program.add(loci::describe_command());
  program.add(loci::index_command());
  program.add(loci::read_command());
  program.add(loci::recognise_command());
  program.add(loci::search_command());
  program.add(loci::serve_command());
  program.add(loci::surface_command());
  program.add(loci::train_command());
  return program.run(argc, argv);
}
