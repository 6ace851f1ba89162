#pragma once

#include <memory>
#include <optional>

#include "mapping/sensor/frame.h"

namespace loci::apps::tracking_evaluation {

/// A method that follows the camera from frame to frame.
class FrameOdometry {
 public:
  virtual ~FrameOdometry() = default;
  /// Motion since the frame before (before_from_now), the identity for the first; nothing when it is lost.
  /// The next call starts from this frame in any case.
  virtual std::optional<Isometry3d> add(const mapping::RgbdFrame& frame) = 0;
};

/// OpenCV's RgbdICPOdometry in its default configuration.
std::unique_ptr<FrameOdometry> opencv_odometry(const mapping::PinholeCamera& camera);
/// Open3D's RGB-D odometry (colour and depth together) in its default configuration; nothing when loci was
/// built without Open3D.
std::unique_ptr<FrameOdometry> open3d_odometry(const mapping::PinholeCamera& camera);

}  // namespace loci::apps::tracking_evaluation
