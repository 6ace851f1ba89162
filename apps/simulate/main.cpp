#include "apps/simulate/commands.h"

int main(int argc, char** argv) {
  loci::apps::Program program("loci-simulate", "Render recordings and laser scans of simulated kitchens");
  program.add(loci::apps::kitchen_command());
  program.add(loci::apps::record_command());
  program.add(loci::apps::scan_command());
  return program.run(argc, argv);
}
