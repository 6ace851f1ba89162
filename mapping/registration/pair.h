#pragma once

#include <vector>

#include "mapping/registration/icp.h"
#include "mapping/registration/parameters.h"
#include "mapping/registration/prepared_scan.h"

namespace loci::mapping::registration {

/// The best poses within a window around a guess: rotations and shifts on a grid are scored by how many
/// coarse surfels of the source lie on surfels of the target with agreeing normals (correlative search, Olson
/// 2009). x, y, yaw when planar, otherwise all six. Omits poses near `known`, to which the guess itself
/// leads, and poses that score far less: after a good guess these are nearly all, and the search is fast.
std::vector<Isometry3d> promising_starts(const PreparedScan& target, const PreparedScan& source,
                                         const Isometry3d& target_from_source, const SearchWindow& window,
                                         const Isometry3d& known, bool planar, size_t count);

/// The agreement of two scans in a relative pose.
struct Agreement {
  double overlap = 0;   ///< part of the smaller scan's surface that is in the other one, too
  double conflict = 0;  ///< of the comparable surfels, the part in space that the other scan saw as free

  /// Orders candidates.
  double score() const { return overlap - 2 * conflict; }
};

/// Compares the surfels of a level, both ways; at most `samples` of each (0 = all). For planar poses the
/// conflict is counted over surfaces that are not horizontal: floors always agree.
Agreement agreement(const PreparedScan& target, const PreparedScan& source,
                    const Isometry3d& target_from_source, size_t level, bool planar, size_t samples);

/// Smallest over largest eigenvalue of the Hessian of the free directions, angles scaled by the size of the
/// overlap to metres: 0 when the pose may slide or rotate, 1 when all directions are equally constrained.
double degeneracy(const Matrix6d& hessian, const Vector3d& about, double lever, bool planar);

/// As PairAlignment states it.
struct Verdict {
  bool trusted = false;
  std::string reason;
  bool ambiguous = false;
};
/// `second_score`: of the best other pose, or a very small number.
Verdict judge(const PairAlignment& pair, const Agreement& agreement, double second_score,
              const RegistrationOptions& options);

/// The search window for the options' expected errors.
SearchWindow window_of(const RegistrationOptions& options);

/// Aligns two prepared scans; the guess and the result are between the scans' own frames.
PairAlignment align_pair(const PreparedScan& target, const PreparedScan& source,
                         const Isometry3d& target_from_source, const SearchWindow& window,
                         const RegistrationOptions& options);

/// Part of the source's coarse surface near the target's at a guess: a fixed-radius search with the expected
/// localisation error (§7.3).
double expected_overlap(const PreparedScan& target, const PreparedScan& source,
                        const Isometry3d& target_from_source);

}  // namespace loci::mapping::registration
