#pragma once

#include "mapping/registration/icp.h"
#include "mapping/registration/prepared_scan.h"

namespace loci::mapping::registration {

/// What two scans say about each other in a relative pose.
struct Agreement {
  double overlap = 0;   ///< part of the smaller scan's surface that the other one has, too
  double conflict = 0;  ///< of what the other scan can tell about, the part in space that it saw to be free
  size_t told = 0;      ///< surfels that the other scan can tell about

  /// What speaks for the pose: orders candidates.
  double score() const { return overlap - 2 * conflict; }
};

/// Compares the surfels of a level, both ways; at most `samples` of each (0 = all). For planar poses the
/// conflict is counted over surfaces that are not horizontal: floors always agree.
Agreement agreement(const PreparedScan& target, const PreparedScan& source,
                    const Isometry3d& target_from_source, size_t level, bool planar, size_t samples);

/// Smallest over largest eigenvalue of the Hessian of the free directions, angles scaled by the size of the
/// overlap so that all are metres: 0 when the pose may slide or turn, 1 when all directions are held alike.
double degeneracy(const Matrix6d& hessian, const Vector3d& about, double lever, bool planar);

/// Whether a pair can be trusted and why, in words.
struct Verdict {
  bool trusted = false;
  std::string reason;
};
/// `rival`: score of the best other pose that was found, or a very small number.
Verdict judge(const PairAlignment& pair, const Agreement& agreement, double rival,
              const RegistrationOptions& options);

}  // namespace loci::mapping::registration
