#include "apps/memory/commands.h"

int main(int argc, char** argv) {
  loci::Program program("loci-memory", "Asks and keeps the spatio-temporal memory.");
  program.add(loci::resolve_command());
  program.add_planned("where", "Where an object is");
  program.add_planned("history", "Where an object was, over time");
  program.add_planned("on", "What is on a place");
  program.add_planned("in", "What is in a place");
  program.add_planned("was", "Was X there between two times: yes, no, or not observed");
  program.add_planned("changes", "What happened between two times");
  program.add_planned("objects", "Lists the objects");
  program.add_planned("scenes", "Lists the scenes");
  program.add_planned("timeline", "Scenes and events in order");
  program.add_planned("verify", "Checks a memory file");
  program.add_planned("report", "A self-contained HTML report");
  program.add_planned("ask", "Asks in words");
  program.add_planned("ingest", "Takes in detections of other systems");
  program.add_planned("reason", "Runs the reasoning again");
  program.add_planned("why", "Explains a decision");
  program.add_planned("export", "Exports a dataset");
  program.add_planned("catalogue", "Object knowledge in and out");
  return program.run(argc, argv);
}
