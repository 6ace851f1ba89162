#include "apps/perceive/commands.h"

int main(int argc, char** argv) {
  loci::Program program("loci-perceive", "Runs perception experts over recordings.");
  program.add(loci::info_command());
  program.add(loci::types_command());
  program.add_planned("run", "Recording to memory through a pipeline of annotators");
  program.add_planned("list", "Lists the annotators");
  program.add_planned("describe", "Describes one annotator");
  program.add_planned("annotate", "Runs annotators over what was remembered");
  program.add_planned("cas", "Converts between XMI and JSON");
  program.add_planned("train", "Trains classifiers from labelled memory");
  return program.run(argc, argv);
}
