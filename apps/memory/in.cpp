#include "apps/memory/commands.h"
#include "apps/memory/memory_arguments.h"

namespace loci::apps {

Command in_command() {
  return {"in",
          "What is in a place",
          {"loci-memory in drawer_1 -m demo-output/memory.loci",
           "loci-memory in drawer_1 -m demo-output/memory.loci --at 08:30"},
          about_place()};
}

}  // namespace loci::apps
