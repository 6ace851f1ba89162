#include "mapping/world/furniture.h"

namespace loci::mapping {

const char* to_text(ArticulationType type) {
  switch (type) {
    case ArticulationType::rigid:
      return "rigid";
    case ArticulationType::prismatic:
      return "prismatic";
    case ArticulationType::revolute:
      return "revolute";
  }
  return "rigid";
}

}  // namespace loci::mapping
