#include "apps/memory/commands.h"
#include "apps/memory/memory_arguments.h"

namespace loci::apps {

Command timeline_command() {
  return {"timeline",
          "Scenes and events in order",
          {"loci-memory timeline -m demo-output/memory.loci",
           "loci-memory timeline -m demo-output/memory.loci --from 09:00 --json"},
          about_span<memory::TimelineQuestion>()};
}

}  // namespace loci::apps
