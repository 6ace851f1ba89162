#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <functional>
#include <numeric>
#include <opencv2/core.hpp>
#include <utility>
#include <vector>

#include "mapping/base/options.h"

namespace loci::perception {

/// Which of `count` objects have been joined to one set (union-find). The smallest member represents a set.
class DisjointSets {
 public:
  explicit DisjointSets(size_t count) : parent_(count) {
    std::iota(parent_.begin(), parent_.end(), size_t{0});
  }

  size_t find(size_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(size_t a, size_t b) {
    a = find(a);
    b = find(b);
    if (a < b) parent_[b] = a;
    if (b < a) parent_[a] = b;
  }

 private:
  std::vector<size_t> parent_;
};

/// How a cloud is split along its concave edges.
struct ConvexPartsOptions {
  double voxel_m = 0.006;
  double patch_voxels = 4;
  double concave_deg = 20;
  double normal_weight = 1.0;
  bool common_neighbour = false;

  void declare(OptionTable& table);
};

/// A cloud as voxels that are grouped into parts.
struct ConvexParts {
  std::vector<int> part_of_point;  ///< in [0, count)
  int count = 0;
  /// Pairs of parts (first < second) that touch, and the number of voxel pairs in which they do, sorted.
  std::vector<std::pair<std::array<int, 2>, int>> contacts;
};

/// Points that hang together: any two of a group are linked by points less than about `reach` apart (cells of
/// that size that touch). Gives a group number per point, in order of the first point, and how many there
/// are.
std::vector<int> euclidean_groups(const std::vector<Eigen::Vector3f>& points, float reach, int& count);

/// Joins groups that the image shows side by side if one surface goes on over most of their contact: far away
/// a slanted surface comes in steps, the quanta of the depth. `pixels`: of each point, row by row; `goes_on`:
/// whether two neighbouring pixels show one surface. `count`: of the groups, before and after.
std::vector<int> join_groups(const std::vector<int>& group_of, const std::vector<int>& pixels,
                             const cv::Size& image, const std::function<bool(int, int)>& goes_on, int& count);

/// Splits a cloud where its surface is concave, as touching objects are and single objects mostly are not
/// (after Stein et al., "Object partitioning using local convexity", CVPR 2014): voxels grow into patches of
/// one orientation, and neighbouring patches stay together when their connection is convex; patches of
/// different colours only where they meet in an edge. `lab`: colours of the points, CIE Lab in 8 bits; empty
/// = unknown. `scale` widens voxels and patches for noisy (far) clouds. Deterministic.
ConvexParts split_at_concave_edges(const std::vector<Eigen::Vector3f>& points,
                                   const std::vector<Eigen::Vector3f>& normals,
                                   const std::vector<cv::Vec3b>& lab, double scale,
                                   const ConvexPartsOptions& options);

/// Groups of points, given by their members, each split at its concave edges, at a scale that follows the
/// depth noise at its distance. `points`: camera frame. The same on any number of threads.
ConvexParts split_groups(const std::vector<Eigen::Vector3f>& points,
                         const std::vector<Eigen::Vector3f>& normals, const std::vector<cv::Vec3b>& lab,
                         const std::vector<std::vector<size_t>>& groups, const ConvexPartsOptions& options,
                         int threads);

/// The numbers of the points of each group, in order.
std::vector<std::vector<size_t>> members_of(const std::vector<int>& group_of, int count);

}  // namespace loci::perception
