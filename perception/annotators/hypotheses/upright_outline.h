#pragma once

#include <Eigen/Core>
#include <vector>

namespace loci::perception {

/// What a camera sees of an upright thing between two heights, from left to right.
struct OutlineBand {
  int points = 0;      ///< that it was measured on
  float width = 0;     ///< between the outermost points to the left and to the right, metres
  float distance = 0;  ///< of the mean from the viewpoint, in the plane, metres
  Eigen::Vector2f middle = Eigen::Vector2f::Zero();  ///< between those two points, in the plane
  Eigen::Vector2f across = Eigen::Vector2f::Zero();  ///< unit vector to the left in the image
};

/// The band between the heights `low` and `high` of the points `members` of a cloud over a support (z =
/// height, metres), as seen from `viewpoint`. Of the outermost points 2 % on either side are left out.
OutlineBand outline_band(const std::vector<Eigen::Vector3f>& cloud, const std::vector<int>& members,
                         const Eigen::Vector2f& viewpoint, float low, float high);

}  // namespace loci::perception
