#include "apps/perceive/annotators.h"

#include "perception/annotators/annotators.h"

namespace loci {

AnnotatorRegistry all_annotators() {
  AnnotatorRegistry registry;
  add_annotators(registry);
  return registry;
}

}  // namespace loci
