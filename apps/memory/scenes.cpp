#include "apps/memory/commands.h"
#include "apps/memory/memory_arguments.h"

namespace loci {

Command scenes_command() {
  return {"scenes",
          "Lists the scenes",
          {"loci-memory scenes -m demo-output/memory.loci",
           "loci-memory scenes -m demo-output/memory.loci --from 09:00 --json"},
          about_span<ScenesQuestion>()};
}

}  // namespace loci
