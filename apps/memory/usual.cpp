#include "apps/memory/commands.h"
#include "apps/memory/memory_arguments.h"

namespace loci {

Command usual_command() {
  return {"usual",
          "Where an object usually is, by hour and weekday",
          {"loci-memory usual red -m demo-output/memory.loci",
           "loci-memory usual object_5 -m demo-output/memory.loci --json"},
          about_object<UsualQuestion>()};
}

}  // namespace loci
