#include "apps/map/commands.h"

int main(int argc, char** argv) {
  loci::Program program("loci-map", "Builds and checks semantic URDF maps.");
  program.add(loci::check_command());
  program.add(loci::fuse_command());
  program.add(loci::interpret_command());
  program.add(loci::compare_command());
  program.add(loci::export_command());
  program.add(loci::explore_command());
  program.add(loci::next_view_command());
  program.add(loci::register_command());
  program.add(loci::articulate_command());
  return program.run(argc, argv);
}
