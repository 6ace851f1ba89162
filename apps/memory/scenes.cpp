#include "apps/memory/commands.h"
#include "apps/memory/memory_arguments.h"

namespace loci::apps {

Command scenes_command() {
  return {"scenes",
          "Lists the scenes",
          {"loci-memory scenes -m demo-output/memory.loci",
           "loci-memory scenes -m demo-output/memory.loci --from 09:00 --json"},
          about_span<memory::ScenesQuestion>()};
}

}  // namespace loci::apps
