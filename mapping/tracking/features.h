#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "mapping/base/math/random.h"
#include "mapping/tracking/frame_images.h"

namespace loci::mapping::tracking {

/// ORB corners of a frame that have a depth.
struct Features {
  std::vector<Vector3d> points;  ///< depth camera's frame
  cv::Mat descriptors;           ///< CV_8U, 32 columns, a row per point
};

Features features_of(const FrameImages& images);

/// A motion that matched features agree on.
struct FeatureMotion {
  Isometry3d a_from_b = Isometry3d::Identity();
  size_t agreeing = 0;
  size_t matches = 0;
};

/// The motion between two frames from mutual nearest descriptors, by samples of three matches. Nothing when
/// too few agree.
std::optional<FeatureMotion> match(const Features& a, const Features& b, Random random);

/// Finds keyframes that look alike: descriptors vote by some of their bits.
class AppearanceIndex {
 public:
  AppearanceIndex();
  void add(const Features& features);
  /// Numbers of the entries with the most votes, best first.
  std::vector<size_t> similar(const Features& features, size_t count) const;

 private:
  template <class Visit>
  void for_each_cell(const Features& features, const Visit& visit) const;

  std::vector<std::vector<int>> bits_;        ///< of the descriptor, by table
  std::vector<std::vector<uint32_t>> cells_;  ///< entries, by table and value of the bits
  size_t entries_ = 0;
};

}  // namespace loci::mapping::tracking
