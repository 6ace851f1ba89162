#include "apps/memory/commands.h"
#include "apps/memory/memory_arguments.h"

namespace loci::apps {

Command lifecycle_command() {
  return {"lifecycle",
          "From where to where things go, again and again",
          {"loci-memory lifecycle red -m demo-output/memory.loci",
           "loci-memory lifecycle green -m demo-output/memory.loci --json"},
          about_object<memory::LifecycleQuestion>()};
}

}  // namespace loci::apps
