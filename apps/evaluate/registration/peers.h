#pragma once

#include <string>
#include <vector>

#include "mapping/sensor/scan.h"

namespace loci::apps::registration_evaluation {

struct PeerResult {
  Isometry3d target_from_source = Isometry3d::Identity();
  bool converged = false;  ///< as the method itself claims
};

/// "PCL ICP", "PCL GICP", "PCL NDT": one thread each.
const std::vector<std::string>& peers();

/// Points are taken as they are. Correspondences reach 1 m, so that starts half a metre off are within reach.
PeerResult align_with_peer(const std::string& peer, const mapping::Scan& target, const mapping::Scan& source,
                           const Isometry3d& target_from_source);

}  // namespace loci::apps::registration_evaluation
