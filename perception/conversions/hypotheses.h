#pragma once

#include <vector>

#include "perception/types/geometry.h"

namespace loci::perception::types {

// Object hypotheses and the points of a cloud. Both throw Error when a hypothesis refers to points that are
// not there.

/// Positions of the points of a cluster in the frame of its cloud, m; points without measurement are left
/// out.
std::vector<Vector3d> positions_of(const ClusterPoints& points);

/// The points of a cloud inside a box or sphere, whose frame is that of `frame_from_cloud`. They are made in
/// the CAS of the volume, with its source.
ReferenceClusterPoints points_in_volume(const TFLinkROI& volume, const PointCloud& cloud,
                                        const Isometry3d& frame_from_cloud);

}  // namespace loci::perception::types
