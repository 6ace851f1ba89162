#pragma once

#include <string>
#include <vector>

#include "mapping/world/world.h"

namespace loci::mapping {

/// A solid shape of a world as the box around it.
struct SolidBox {
  size_t link = 0;  ///< index into world.links
  Isometry3d link_from_box = Isometry3d::Identity();
  Vector3d half = Vector3d::Zero();  ///< of its sides
};

/// The collision shapes of all links. Cylinders and spheres become the boxes around them; meshes are left
/// out.
std::vector<SolidBox> solid_boxes(const World& world);

/// The same box seen from another frame: the smallest box along that frame's axes around it.
Eigen::AlignedBox3d bounds_of(const SolidBox& box, const Isometry3d& frame_from_link);

/// Two links that penetrate each other although a joint lets them move against each other.
struct Contact {
  std::string first, second;  ///< first moves
  double depth = 0;           ///< m, of the deepest pair of shapes
};

/// Contacts of a world in its closed state (all joints at 0), deepest first. A link and what it hangs on by a
/// moving joint do not count, unless that stands still (as in physics engines).
std::vector<Contact> closed_contacts(const World& world);

/// How far a joint moves before something is in its way.
struct FreeRange {
  double upper = 0;     ///< the joint's own limit, or the last position before the contact
  std::string blocker;  ///< link that is in the way; empty = none
  std::string mover;    ///< link that meets it
};

/// Moves a joint from 0 to its upper limit with all others at 0, in steps of 5 mm or 1°. What it penetrates
/// at 0 is not in its way. Error for a joint without limits.
FreeRange free_range(const World& world, const Joint& joint);

}  // namespace loci::mapping
