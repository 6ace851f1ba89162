#pragma once

#include <string>
#include <vector>

#include "mapping/base/math/random.h"
#include "mapping/world/mesh.h"

namespace loci::mapping {

/// An object as it stands, lies or is turned over: z up, its lowest point at z = 0.
struct HouseholdObject {
  TriangleMesh mesh;
  double reach = 0;  ///< no point is further from the z axis
  double top = 0;    ///< height of what may stand on it
  double room = 0;   ///< so far from the z axis its top is flat; 0 = nothing stands on it
  double foot = 0;   ///< the same of the foot of a vessel that is turned over; 0 = it is none
};

/// Classes of objects of a household, sorted: "apple", "banana", …
const std::vector<std::string>& household_classes();

/// An object of a class with drawn size, proportions, colours, label and rest position. Any other name gives
/// something that belongs to none of the classes: a keyboard, a bent tube, boxes grown together.
HouseholdObject draw_household_object(const std::string& class_name, Random& draw);

}  // namespace loci::mapping
