#pragma once

#include <Eigen/Core>
#include <array>
#include <utility>
#include <vector>

#include "mapping/base/options.h"

namespace loci::perception {

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

/// Splits a cloud where its surface is concave, as touching things are and single things mostly are not
/// (after Stein et al., "Object partitioning using local convexity", CVPR 2014): voxels grow into patches of
/// one orientation, and neighbouring patches stay together when their connection is convex. `scale` widens
/// voxels and patches for noisy (far) clouds. Deterministic.
ConvexParts split_at_concave_edges(const std::vector<Eigen::Vector3f>& points,
                                   const std::vector<Eigen::Vector3f>& normals, double scale,
                                   const ConvexPartsOptions& options);

}  // namespace loci::perception
