#include "apps/evaluate/commands.h"

int main(int argc, char** argv) {
  loci::Program program("loci-evaluate", "Measures every claim against its peers.");
  program.add(loci::articulation_command());
  program.add(loci::changes_command());
  program.add(loci::days_command());
  program.add(loci::description_command());
  program.add(loci::filter_command());
  program.add(loci::mapping_command());
  program.add(loci::identity_command());
  program.add(loci::registration_command());
  program.add(loci::segmentation_command());
  program.add(loci::nbv_command());
  program.add(loci::normals_command());
  program.add(loci::occupancy_command());
  program.add(loci::memory_command());
  program.add(loci::system_command());
  return program.run(argc, argv);
}
