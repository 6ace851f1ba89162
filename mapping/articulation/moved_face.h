#pragma once

#include <array>
#include <functional>
#include <optional>
#include <vector>

#include "mapping/base/math/pose.h"
#include "mapping/world/furniture.h"

namespace loci::mapping {

/// A plane fitted to points: normal · p = offset.
struct FittedPlane {
  Vector3d normal = Vector3d::UnitZ();
  double offset = 0;
  double normal_sd = 0;  ///< radians
  size_t points = 0;

  double distance(const Vector3d& p) const { return normal.dot(p) - offset; }
  FittedPlane flipped() const { return {-normal, -offset, normal_sd, points}; }
};

/// Repeated least squares over the points within `reach` of a plane; the normal keeps its side.
FittedPlane refined_plane(const FittedPlane& start, const std::vector<Vector3d>& points, double reach);

/// The plane of most points among those with an allowed normal (random sample consensus with a fixed seed).
std::optional<FittedPlane> find_plane(const std::vector<Vector3d>& points,
                                      const std::function<bool(const Vector3d&)>& allowed);

/// The two ends of a uniformly covered interval with outliers: where the density of positions falls to half
/// of the usual one.
std::array<double, 2> interval_of(const std::vector<double>& positions);

/// The motion of a part: its joint, and the joint position in the open scan.
struct Motion {
  ArticulationType type = ArticulationType::rigid;
  Vector3d axis = Vector3d::UnitX(), origin = Vector3d::Zero();
  double position = 0;
  double axis_sd_deg = 0, origin_sd_m = 0;

  Isometry3d moved_from_closed() const;
};

/// The plane of a moved part, and the motion that brought the front there.
struct MovedFace {
  Motion motion;
  FittedPlane open;
  double coverage = 0;  ///< of the front's rectangle by the plane moved back, 0 to 1
};

/// The plane of a closed front: fitted to its points without fixture and combined with the normal in the map,
/// or as in the map where little was seen.
FittedPlane closed_face(const std::vector<Vector3d>& points, const Front& front);

/// The share of a front's rectangle, by cells of 3 cm, where its closed face is still seen.
double static_share(const std::vector<Vector3d>& points, const FittedPlane& closed, const Front& front);

/// The best sliding part and the best part that rotates about an upright or a level hinge, by
/// ArticulationType; unset where there is none.
std::array<std::optional<MovedFace>, 3> moved_faces(const FittedPlane& closed,
                                                    const std::vector<Vector3d>& moved, const Front& front,
                                                    double tolerance);

}  // namespace loci::mapping
