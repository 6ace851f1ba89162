#include "apps/simulate/commands.h"

int main(int argc, char** argv) {
  loci::Program program("loci-simulate", "Makes worlds and recordings with ground truth.");
  program.add(loci::record_command());
  program.add(loci::scan_command());
  return program.run(argc, argv);
}
