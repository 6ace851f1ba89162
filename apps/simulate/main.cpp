#include "apps/cli/program.h"

int main(int argc, char** argv) {
  loci::Program program("loci-simulate", "Makes worlds and recordings with ground truth.");
  program.add_planned("record", "Plays a scenario and renders it");
  program.add_planned("scan", "Scans a world with a simulated laser");
  return program.run(argc, argv);
}
