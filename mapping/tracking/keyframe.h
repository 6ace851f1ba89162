#pragma once

#include <array>
#include <vector>

#include "mapping/tracking/features.h"
#include "mapping/tracking/frame_images.h"
#include "mapping/tracking/parameters.h"

namespace loci::mapping::tracking {

/// A point of the model with what a frame is compared with, in the camera frame of its keyframe.
struct ModelPoint {
  Eigen::Vector3f position;
  Eigen::Vector3f normal;
  float intensity = 0;  ///< NaN = unknown
};

/// A frame whose depth is refined by those that are tracked against it: a piece of the model. Of the images
/// it holds what the model is made of, as a walk has hundreds of keyframes.
class Keyframe {
 public:
  Keyframe(size_t number, const FrameImages& images, Features features);

  size_t frame() const { return number_; }
  const Features& features() const { return features_; }
  /// Model points for a level of the pyramid.
  const std::vector<ModelPoint>& points(size_t level) const { return points_[level]; }
  size_t levels() const { return points_.size(); }
  /// Of the depth.
  const PinholeCamera& camera() const { return camera_; }
  /// CV_32F, 1/m, fused; 0 = no measurement.
  const cv::Mat& inverse_depth() const { return inverse_depth_; }

  /// Averages in the depth of a frame that sees the same surfaces.
  void fuse(const FrameImages& frame, const Isometry3d& frame_from_keyframe);

 private:
  void rebuild_points();

  struct Intensity {
    PinholeCamera camera;
    cv::Mat logarithm;  ///< CV_32F; may be empty
  };

  size_t number_;
  PinholeCamera camera_;   ///< of the depth
  cv::Mat inverse_depth_;  ///< CV_32F, fused
  cv::Mat normals_;        ///< CV_32FC3
  cv::Mat weights_;        ///< CV_8U, in frames
  Isometry3d color_from_depth_;
  std::vector<Intensity> intensities_;  ///< by level
  Features features_;
  std::vector<std::vector<ModelPoint>> points_;
  int fused_ = 0;
};

}  // namespace loci::mapping::tracking
