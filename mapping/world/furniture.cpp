#include "mapping/world/furniture.h"

namespace loci::mapping {

const char* joint_estimate_type_name(JointEstimate::Type type) {
  switch (type) {
    case JointEstimate::Type::rigid:
      return "rigid";
    case JointEstimate::Type::prismatic:
      return "prismatic";
    case JointEstimate::Type::revolute:
      return "revolute";
  }
  return "rigid";
}

}  // namespace loci::mapping
