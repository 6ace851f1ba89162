#include "apps/perceive/annotators.h"

#include "memory/annotators/memory_annotators.h"
#include "perception/annotators/annotators.h"

namespace loci {

AnnotatorRegistry all_annotators() {
  AnnotatorRegistry registry;
  add_annotators(registry);
  add_memory_annotators(registry);
  return registry;
}

}  // namespace loci
