#include "apps/map/commands.h"

int main(int argc, char** argv) {
  loci::apps::Program program("loci-map", "Build and check semantic URDF maps");
  program.add(loci::apps::check_command());
  program.add(loci::apps::track_command());
  program.add(loci::apps::fuse_command());
  program.add(loci::apps::interpret_command());
  program.add(loci::apps::compare_command());
  program.add(loci::apps::export_command());
  program.add(loci::apps::explore_command());
  program.add(loci::apps::next_view_command());
  program.add(loci::apps::register_command());
  program.add(loci::apps::articulate_command());
  program.add(loci::apps::update_command());
  return program.run(argc, argv);
}
