#pragma once

#include <vector>

#include "mapping/base/math/pose.h"
#include "mapping/sensor/camera.h"
#include "mapping/world/mesh.h"

namespace loci::perception {

/// A point of a surface of the map, and the unit normal out of it.
struct SurfaceSample {
  Vector3d point, normal;
};

/// Points about `spacing` metres apart on the surface of a visual, in the frame of its link.
void add_surface_samples(const mapping::Visual& visual, const mapping::MeshSearch& meshes, double spacing,
                         std::vector<SurfaceSample>& samples);

/// Surfaces that face the camera less are not compared with a depth image (cosine).
inline constexpr double kFacing = 0.2;

/// Standard deviations of the depth by which all of a surface may lie off the map: depth cameras distort and
/// maps drift by more than single pixels scatter.
inline constexpr double kDistortion = 7;

/// The pixel that a point (camera frame) falls into, row · width + column; -1 outside.
inline int pixel_of(const Vector3d& point, const mapping::PinholeCamera& camera) {
  if (!(point.z() > 0.1)) return -1;
  const Vector2d at = camera.project(point);
  if (!(at.x() > -0.5 && at.y() > -0.5 && at.x() < camera.width - 0.5 && at.y() < camera.height - 0.5))
    return -1;
  return static_cast<int>(at.y() + 0.5) * camera.width + static_cast<int>(at.x() + 0.5);
}

}  // namespace loci::perception
