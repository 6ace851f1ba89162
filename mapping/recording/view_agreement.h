#pragma once

#include <array>
#include <functional>
#include <map>
#include <opencv2/core.hpp>
#include <optional>

#include "mapping/recording/recording.h"

namespace loci::mapping {

/// How views are compared.
inline constexpr struct {
  size_t places = 12;                       ///< in the recording, where pairs are taken
  std::array<size_t, 3> gaps = {1, 5, 30};  ///< frames between the two of a pair: far ones show late poses
  int samples = 60;                         ///< pixels along the longer side of an image
  double tolerance_m = 0.03;                ///< in depth
  double tolerance_share = 0.02;            ///< of the depth, besides
  size_t min_compared = 2000;               ///< pixels that say anything
} kViews;

/// How a depth image is understood.
struct DepthReading {
  PinholeCamera camera;     ///< a negative fx = of a mirrored image
  bool along_rays = false;  ///< depth is the distance from the camera, not z

  /// z of what is stored at a pixel.
  double z(double u, double v, double depth) const;
};

/// What a frame sees where another one saw it, under their poses.
struct ViewCounts {
  size_t sampled = 0, compared = 0, agreeing = 0;
  double difference_m = 0;  ///< in depth, summed over what was compared; more than the tolerance counts as it

  bool says_something() const { return compared >= kViews.min_compared; }
  double share() const;
  double mean_difference_m() const;
  ViewCounts& operator+=(const ViewCounts& other);
};

/// By the frames between the two of a pair, as kViews.gaps.
using CountsByGap = std::array<ViewCounts, kViews.gaps.size()>;

ViewCounts sum(const CountsByGap& counts);
/// Of the pairs that agree least, among those that say something; of all pairs where none does.
ViewCounts worst(const CountsByGap& counts);

/// The pose of a frame.
using PoseOf = std::function<std::optional<Isometry3d>(size_t)>;

/// The frames of a recording that are compared, read once.
class Views {
 public:
  explicit Views(const Recording& recording);

  CountsByGap counts(const PoseOf& pose) { return counts(pose, as_read_); }
  CountsByGap counts(const PoseOf& pose, const DepthReading& reading);
  /// Of the first frame with others all over the recording.
  ViewCounts counts_with_first(const PoseOf& pose);
  /// Whether the cameras are farther apart than a room is large, by what they see of it.
  bool far_apart(const PoseOf& pose);

 private:
  const cv::Mat& depth(size_t i);

  const Recording& recording_;
  DepthReading as_read_;
  size_t step_;  ///< between the places
  std::map<size_t, cv::Mat> depths_;
};

}  // namespace loci::mapping
