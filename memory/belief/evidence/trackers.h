#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

namespace loci::memory::belief {

/// The single-cue trackers of §6.1.2.
inline constexpr std::array<const char*, 3> kTrackers{"position", "shape", "color"};

/// Distances by tracker, observations × objects, row by row; infinite = not comparable.
struct TrackerDistances {
  size_t observations = 0;
  std::vector<int64_t> keys;                               ///< of the objects
  std::array<std::vector<double>, kTrackers.size()> of{};  ///< metres between centres; of extents; of colours
};

/// Proposals of the trackers for an observation: key of the mutual nearest neighbour by centre, extents and
/// colour. Unset = nothing near enough, nothing to compare, or not mutual.
struct TrackerVotes {
  std::array<std::optional<int64_t>, kTrackers.size()> key;
  /// All trackers agree, and nothing else is near: settled by the arbiter, without the model.
  std::optional<int64_t> settled;
};

/// One per observation.
std::vector<TrackerVotes> votes(const TrackerDistances& distances);

}  // namespace loci::memory::belief
