#include "apps/memory/commands.h"
#include "apps/memory/memory_arguments.h"

namespace loci {

Command about_command() {
  return {"about",
          "What is known about an object: what annotators and people say of it",
          {"loci-memory about red -m demo-output/memory.loci",
           "loci-memory about object_1 -m demo-output/memory.loci --json"},
          about_object<AboutQuestion>()};
}

}  // namespace loci
