#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <string>

#include "mapping/base/math/pose.h"
#include "mapping/base/time.h"
#include "mapping/sensor/camera.h"

namespace loci::mapping {

/// One moment of an RGB-D recording.
struct RgbdFrame {
  int64_t index = 0;  ///< as in the recording: its index column, or the position where there is none
  std::string name;   ///< of its depth image without "depth": "frame-000012", "learn33"
  TimeNs time_ns = 0;
  RgbdCamera camera;
  cv::Mat depth;  ///< CV_32F, z-depth in metres, NaN = no measurement; camera.depth.height × width
  cv::Mat color;  ///< CV_8UC3, BGR; camera.color.height × width; may be empty
  std::optional<Isometry3d> map_from_camera;  ///< pose of the depth camera; unset = unknown
  JointState joints;                          ///< of the map's articulated parts, at this time
  std::string damage;  ///< why an image could not be read: depth is NaN or colour empty then; else empty
};

/// Whether anything was measured.
inline bool has_depth(const RgbdFrame& frame) {
  return !frame.depth.empty() && cv::countNonZero(frame.depth > 0) > 0;
}

/// The colour image as the depth camera would see it (CV_8UC3, depth resolution): each depth pixel takes
/// the colour of the colour pixel that its point projects to; black where there is no depth or no colour.
cv::Mat color_in_depth(const RgbdFrame& frame);

}  // namespace loci::mapping
