#pragma once

#include <array>
#include <optional>
#include <vector>

#include "mapping/articulation/face.h"
#include "mapping/articulation/joint_fit.h"
#include "mapping/world/furniture.h"

namespace loci::mapping {

/// A face that points which moved lie on, and the motion that brought the front there.
struct MovedFace {
  Motion motion;
  Face open;
  double coverage = 0;  ///< of the front's rectangle by the face once it is put back, 0 to 1
};

/// The face of a closed front: the plane through what was seen of it, or as it is told where little was seen.
Face closed_face(const std::vector<Vector3d>& points, const Front& front);

/// The share of a front's rectangle, by cells of 3 cm, where its face is still seen in its place.
double still_share(const std::vector<Vector3d>& points, const Face& closed, const Front& front);

/// The best explanation by a part that slid out and by one that turned about an upright or a level hinge
/// (their index is their JointEstimate::Type); none, or a coverage of 0, where there is no such face.
std::array<std::optional<MovedFace>, 3> moved_faces(const Face& closed, const std::vector<Vector3d>& moved,
                                                    const Front& front, double tolerance);

}  // namespace loci::mapping
