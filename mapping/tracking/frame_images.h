#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "mapping/sensor/frame.h"

namespace loci::mapping::tracking {

/// One level of the pyramid of a frame. Depth and colour keep their own cameras: colour needs no
/// registration.
struct ImageLevel {
  PinholeCamera depth_camera;
  PinholeCamera color_camera;
  cv::Mat inverse_depth;  ///< CV_32F, 1/m, smoothed; 0 = no measurement
  cv::Mat normals;        ///< CV_32FC3, unit, towards the camera; zero = unknown
  cv::Mat intensity;      ///< CV_32FC3: logarithmic intensity and its gradient along x and y; may be empty
};

/// A frame as tracking sees it, finest level first.
struct FrameImages {
  std::vector<ImageLevel> levels;
  cv::Mat gray;  ///< CV_8U, colour camera of the finest level; may be empty
  Isometry3d depth_from_color = Isometry3d::Identity();
  double measured = 0;  ///< part of the finest level with depth
};

/// `offsets`: CV_32F of the finest level, 1/m, subtracted from its inverse depth; may be empty.
FrameImages frame_images(const RgbdFrame& frame, const cv::Mat& offsets = {});

/// Normals of surfaces in an image of inverse depth (CV_32F, 0 = none), from differences over 2 · `step`
/// pixels: on a plane inverse depth is a linear function of the pixel, and its coefficients are the normal.
cv::Mat normals_of(const cv::Mat& inverse_depth, const PinholeCamera& camera, int step);

/// A motion for inner loops.
struct FloatMotion {
  explicit FloatMotion(const Isometry3d& motion)
      : rotation(motion.linear().cast<float>()), translation(motion.translation().cast<float>()) {}
  Eigen::Vector3f operator*(const Eigen::Vector3f& point) const { return rotation * point + translation; }

  Eigen::Matrix3f rotation;
  Eigen::Vector3f translation;
};

/// Bilinear interpolation of an image of floats (or cv::Vec of them); false outside.
template <class Value>
bool interpolated(const cv::Mat& image, const Eigen::Vector2f& pixel, Value& value) {
  if (!(pixel.x() >= 0 && pixel.y() >= 0)) return false;
  const auto u = static_cast<int>(pixel.x()), v = static_cast<int>(pixel.y());
  if (u + 1 >= image.cols || v + 1 >= image.rows) return false;
  const float a = pixel.x() - static_cast<float>(u), b = pixel.y() - static_cast<float>(v);
  const auto* above = image.ptr<Value>(v) + u;
  const auto* below = image.ptr<Value>(v + 1) + u;
  value = (1 - b) * ((1 - a) * above[0] + a * above[1]) + b * ((1 - a) * below[0] + a * below[1]);
  return true;
}

/// A camera whose pixels are `factor` times as wide.
PinholeCamera coarser(const PinholeCamera& camera, int factor);

/// On the logarithmic scale of ImageLevel::intensity.
float log_intensity(float intensity);
/// Whether an intensity on that scale says no more than that it is bright.
bool is_saturated(float logarithm);

}  // namespace loci::mapping::tracking
