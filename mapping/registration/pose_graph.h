#pragma once

#include <vector>

#include "mapping/registration/registration.h"

namespace loci::mapping::registration {

/// A measured relative pose of two nodes.
struct Edge {
  size_t target = 0, source = 0;
  Isometry3d target_from_source = Isometry3d::Identity();
  Eigen::Matrix<double, 6, 6> information;  ///< of a motion in the target's frame
};

/// Least squares with a robust loss over relative poses; fixed nodes stay. Planar: only x, y and yaw (about
/// the map's z) of the nodes change. Returns how far each edge is off at the end, in standard deviations.
std::vector<double> solve_pose_graph(std::vector<Isometry3d>& map_from_node, const std::vector<bool>& fixed,
                                     const std::vector<Edge>& edges, bool planar);

}  // namespace loci::mapping::registration
