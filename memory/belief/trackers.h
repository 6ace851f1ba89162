#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

namespace loci::memory::belief {

/// The simple trackers of §6.1.2: each looks at one thing alone.
inline constexpr std::array<const char*, 3> kTrackers{"position", "shape", "color"};

/// What the trackers look at. Distances are observations × objects, row by row; infinite = not comparable.
struct TrackerDistances {
  size_t observations = 0;
  std::vector<int64_t> keys;                               ///< of the objects
  std::array<std::vector<double>, kTrackers.size()> of{};  ///< metres between centres; of extents; of colours
};

/// Which believed object (its key) an observation is by each tracker: that which is nearest to it while it is
/// the nearest to that, by the offset of their centres, by their extents, by their colours. Unset = nothing
/// near enough, nothing to compare, or not mutual.
struct TrackerVotes {
  std::array<std::optional<int64_t>, kTrackers.size()> key;
  /// All trackers say so, and nothing else comes near: what the arbiter settles without the model.
  std::optional<int64_t> settled;
};

/// Nothing beyond this distance between centres plays a part in what is settled, metres.
inline constexpr double kTrackersReach = 0.25;

/// One per observation.
std::vector<TrackerVotes> votes(const TrackerDistances& distances);

}  // namespace loci::memory::belief
