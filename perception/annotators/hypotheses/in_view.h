#pragma once

#include <cmath>

#include "mapping/base/pose.h"
#include "mapping/sensor/camera.h"

namespace loci::perception {

/// Whether nothing of a ball (camera frame, metres) can fall into a pixel: it lies behind the camera or
/// outside one of the planes through its centre and an edge of the image (a pixel more on every side).
inline bool out_of_view(const Vector3d& middle, double radius, const mapping::PinholeCamera& camera) {
  const auto outside = [&](double x, double y, double z) {
    return x * middle.x() + y * middle.y() + z * middle.z() < -1.001 * radius * std::hypot(x, y, z) - 1e-6;
  };
  return outside(0, 0, 1) || outside(camera.fx, 0, camera.cx + 1) || outside(0, camera.fy, camera.cy + 1) ||
         outside(-camera.fx, 0, camera.width - camera.cx) ||
         outside(0, -camera.fy, camera.height - camera.cy);
}

}  // namespace loci::perception
