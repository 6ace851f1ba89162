#include "apps/memory/commands.h"
#include "apps/memory/memory_arguments.h"

namespace loci::apps {

Command where_command() {
  return {"where",
          "Where an object is",
          {"loci-memory where red -m demo-output/memory.loci",
           "loci-memory where object_1 -m demo-output/memory.loci --at 08:30 --json"},
          about_object<memory::WhereQuestion>()};
}

}  // namespace loci::apps
