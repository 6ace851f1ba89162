#pragma once

#include <optional>
#include <string>
#include <vector>

#include "memory/belief/evidence/prediction.h"
#include "memory/belief/evidence/trackers.h"
#include "memory/identity/problem.h"

namespace loci::memory::belief {

/// Evidence between believed objects (rows, in the order of BeliefState::objects) and observations (columns).
/// Settled observations are not compared with objects out of view: they have no distances to those.
struct PairEvidence {
  struct Distances {
    std::string kind;
    PairTable distance;   ///< NaN = not comparable
    PairTable log_ratio;  ///< its evidence; 0 = not comparable
  };
  std::vector<Distances> distances;
  PairTable offset;      ///< between the centres, metres
  PairTable similarity;  ///< the dissertation's, in [0,1]; NaN = nothing comparable
  PairTable log_similar, log_proximity;
  Eigen::Array<bool, Eigen::Dynamic, Eigen::Dynamic> achromatic;  ///< both are
  PairTable log_size, log_class;  ///< parts of log_similar that are due to these; 0 = not comparable
  PairTable log_same_print;       ///< of staying unchanged: whether the same side shows the print that it had
  std::vector<TrackerVotes> votes;  ///< per observation
  std::vector<std::optional<size_t>>
      settled;  ///< per observation: row of the object that the arbiter assigned
};

PairEvidence pair_evidence(const BeliefState& state, const std::vector<Prediction>& predicted,
                           const Scene& scene, const BeliefOptions& options);

}  // namespace loci::memory::belief
