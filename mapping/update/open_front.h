#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "mapping/sensor/scan.h"
#include "mapping/update/epoch.h"
#include "mapping/world/furniture.h"

namespace loci::mapping {

/// A visit: its scans, and their surface.
struct Visit {
  const ScanSet& scans;
  const Epoch& epoch;
};

/// A front that stands open now and was closed before.
struct OpenFront {
  JointEstimate joint;
  double position = 0;  ///< of the joint, metres or radians
  double probability = 0;
  std::string reason;
  std::vector<uint32_t> surfels;  ///< of now, that it explains
};

/// Whether a front stands open: by the motion between the visits, or where the known joint takes it, which a
/// door that hides its own inside needs, and one that was seen in part. `unexplained`: surfels of now that
/// the map does not explain.
std::optional<OpenFront> open_front(const Front& front, const Visit& before, const Visit& now,
                                    const std::vector<uint8_t>& unexplained);

/// Whether a position is on the face of a closed front.
bool on_front(const Front& front, const Eigen::Vector3f& position);

}  // namespace loci::mapping
