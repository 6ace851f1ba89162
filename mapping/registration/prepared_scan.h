#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

#include "mapping/registration/parameters.h"
#include "mapping/registration/registration.h"
#include "mapping/registration/surfels.h"
#include "mapping/sensor/scan.h"

namespace loci::mapping::registration {

/// Ranges by direction from each origin of a scan, as a small image on a cube around the origin: whether rays
/// passed a point.
class FreeSpace {
 public:
  FreeSpace() = default;
  /// `level_from_scan` transforms into the frame of the queries. Scans with many origins use every n-th.
  FreeSpace(const Scan& scan, const Isometry3d& level_from_scan);

  /// Whether rays of the scan passed the point with more than `margin` metres (plus 2 % of the range) to go.
  bool passed(const Eigen::Vector3f& point, float margin) const;
  /// The same for a point of a surface, with the margin along its normal: rays that run along a surface end
  /// on it far from where noise lets them. A zero normal is none.
  bool passed(const Eigen::Vector3f& point, const Eigen::Vector3f& normal, float margin) const;
  bool known() const { return !images_.empty(); }
  /// Part of the points that other points of the scan hide from the origins: near 0 for correct origins.
  double hidden_part() const { return hidden_part_; }
  /// Whether the points can have been seen from the origins.
  bool plausible() const { return known() && hidden_part() < kSurfels.max_hidden; }

 private:
  using CubeFace = std::array<float, size_t{kSurfels.image_side} * kSurfels.image_side>;

  struct Image {
    Eigen::Vector3f origin;
    std::array<CubeFace, 6> nearest;  ///< range; 0: no ray went there

    float& towards(const Eigen::Vector3f& direction);
  };

  static std::pair<int, int> pixel_of(const Eigen::Vector3f& direction);
  void stop_at_points_of_others(const Scan& scan, const Eigen::Isometry3f& level);
  void erode();

  std::vector<Image> images_;
  double hidden_part_ = 0;
};

/// A scan prepared for all its pairs. Its points are in the scan's frame or, for planar registration, in that
/// frame rotated upright, where a robot's pose is x, y and yaw.
struct PreparedScan {
  std::string name;
  Isometry3d level_from_scan = Isometry3d::Identity();
  std::vector<Surfels> levels;  ///< finest first, cells twice as wide each
  CellGrid dilated_grid;        ///< of the coarsest level
  FreeSpace free_space;
  Eigen::Vector3f centre = Eigen::Vector3f::Zero();  ///< mean of the origins: centre of rotation
  size_t points = 0;                                 ///< that were returned

  const Surfels& finest() const { return levels.front(); }
  const Surfels& coarsest() const { return levels.back(); }
};

PreparedScan prepare(const Scan& scan, const RegistrationOptions& options);

}  // namespace loci::mapping::registration
