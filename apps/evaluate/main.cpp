#include "apps/evaluate/commands.h"

int main(int argc, char** argv) {
  loci::apps::Program program("loci-evaluate", "Measure loci against ground truth and other methods");
  program.add(loci::apps::articulation_command());
  program.add(loci::apps::changes_command());
  program.add(loci::apps::days_command());
  program.add(loci::apps::description_command());
  program.add(loci::apps::detection_command());
  program.add(loci::apps::filter_command());
  program.add(loci::apps::fleet_command());
  program.add(loci::apps::mapping_command());
  program.add(loci::apps::identity_command());
  program.add(loci::apps::registration_command());
  program.add(loci::apps::segmentation_command());
  program.add(loci::apps::nbv_command());
  program.add(loci::apps::normals_command());
  program.add(loci::apps::occupancy_command());
  program.add(loci::apps::memory_command());
  program.add(loci::apps::mesh_command());
  program.add(loci::apps::placement_command());
  program.add(loci::apps::questions_command());
  program.add(loci::apps::system_command());
  program.add(loci::apps::tracking_command());
  program.add(loci::apps::update_command());
  return program.run(argc, argv);
}
