#include "apps/memory/commands.h"
#include "apps/memory/memory_arguments.h"

namespace loci {

Command history_command() {
  return {"history",
          "Where an object was, over time",
          {"loci-memory history object_1 -m demo-output/memory.loci",
           "loci-memory history red -m demo-output/memory.loci --json"},
          about_object<HistoryQuestion>()};
}

}  // namespace loci
