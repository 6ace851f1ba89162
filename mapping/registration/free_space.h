#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "mapping/sensor/scan.h"

namespace loci::mapping::registration {

/// How far a scan saw in each direction from each of its origins: a small image of ranges on a cube around
/// the origin, which answers whether a point stands in space that rays passed.
class FreeSpace {
 public:
  FreeSpace() = default;
  /// `level_from_scan` turns the scan into the frame in which points are asked for. Scans with more origins
  /// than are worth an image each use every n-th.
  FreeSpace(const Scan& scan, const Isometry3d& level_from_scan);

  /// Whether rays of the scan passed the point with more than `margin` metres (plus 2 % of the range) to go.
  bool passed(const Eigen::Vector3f& point, float margin) const;
  bool known() const { return !images_.empty(); }
  /// Part of the points that some other point of the scan hides when seen from the origins: near 0 when the
  /// origins are where the scan was taken from.
  double hidden_part() const { return hidden_part_; }

 private:
  static constexpr int kSide = 64;  ///< pixels of a face's side: 1.4 degrees each in the middle
  using Face = std::array<float, size_t{kSide} * kSide>;

  struct Image {
    Eigen::Vector3f origin;
    std::array<Face, 6> nearest;  ///< range; 0: no ray went there
  };

  static std::pair<int, int> pixel_of(const Eigen::Vector3f& direction);
  void erode();

  std::vector<Image> images_;
  double hidden_part_ = 0;
};

}  // namespace loci::mapping::registration
