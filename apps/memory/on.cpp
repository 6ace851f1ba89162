#include "apps/memory/commands.h"
#include "apps/memory/memory_arguments.h"

namespace loci::apps {

Command on_command() {
  return {"on",
          "What is on a place",
          {"loci-memory on table_1 -m demo-output/memory.loci",
           "loci-memory on table_1 -m demo-output/memory.loci --at 08:30"},
          about_place()};
}

}  // namespace loci::apps
