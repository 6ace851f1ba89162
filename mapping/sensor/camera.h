#pragma once

#include "mapping/base/math/pose.h"

namespace loci::mapping {

/// A pinhole without distortion. Pixel centres are at integers; optical frame: x right, y down, z forward.
struct PinholeCamera {
  int width = 640;
  int height = 480;
  double fx = 585;
  double fy = 585;
  double cx = 320;
  double cy = 240;

  /// Pixel (u, v) of a point in the optical frame with z > 0.
  Vector2d project(const Vector3d& point) const {
    return {fx * point.x() / point.z() + cx, fy * point.y() / point.z() + cy};
  }
  /// The point at z-depth `z` (metres) behind pixel (u, v).
  Vector3d unproject(double u, double v, double z) const { return {(u - cx) / fx * z, (v - cy) / fy * z, z}; }
  /// Whether a pixel position falls on the image.
  bool contains(const Vector2d& pixel) const {
    return pixel.x() >= -0.5 && pixel.y() >= -0.5 && pixel.x() < width - 0.5 && pixel.y() < height - 0.5;
  }
  bool operator==(const PinholeCamera&) const = default;
};

/// A depth camera and a colour camera on one body. The depth camera's optical frame is *the* camera frame.
struct RgbdCamera {
  PinholeCamera depth;
  PinholeCamera color;
  Isometry3d depth_from_color = Isometry3d::Identity();
};

}  // namespace loci::mapping
