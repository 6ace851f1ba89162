#include "apps/memory/commands.h"
#include "apps/memory/memory_arguments.h"

namespace loci::apps {

Command about_command() {
  return {"about",
          "What is known about an object: what annotators and people say of it",
          {"loci-memory about red -m demo-output/memory.loci",
           "loci-memory about object_1 -m demo-output/memory.loci --json"},
          about_object<memory::AboutQuestion>()};
}

}  // namespace loci::apps
