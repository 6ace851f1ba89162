#pragma once

#include <array>
#include <functional>
#include <optional>
#include <vector>

#include "mapping/base/pose.h"

namespace loci::mapping {

/// A plane that points were measured on: normal · p = offset.
struct Face {
  Vector3d normal = Vector3d::UnitZ();
  double offset = 0;
  double normal_sd = 0;  ///< radians
  size_t points = 0;

  double distance(const Vector3d& p) const { return normal.dot(p) - offset; }
  Face flipped() const { return {-normal, -offset, normal_sd, points}; }
};

/// Least squares over the points within `reach` of a face, repeated as they settle; the normal keeps its
/// side.
Face refined_face(const Face& start, const std::vector<Vector3d>& points, double reach);

/// The plane of most points among those whose normal is allowed (random sample consensus with a fixed seed).
std::optional<Face> find_face(const std::vector<Vector3d>& points,
                              const std::function<bool(const Vector3d&)>& allowed);

/// The two ends of a uniformly covered stretch in the presence of stragglers: where the density of places
/// falls to half of what is usual.
std::array<double, 2> outline_of(const std::vector<double>& places);

}  // namespace loci::mapping
