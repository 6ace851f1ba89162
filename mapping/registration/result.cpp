#include <fmt/format.h>

#include <algorithm>

#include "mapping/base/json.h"
#include "mapping/registration/registration.h"

namespace loci::mapping {

bool RegistrationResult::usable() const {
  return names.size() <= 1 ||
         std::any_of(pairs.begin(), pairs.end(), [](const PairAlignment& pair) { return pair.trusted; });
}

size_t RegistrationResult::connected_count() const {
  return static_cast<size_t>(std::count(connected.begin(), connected.end(), true));
}

std::string RegistrationResult::summary() const {
  const auto trusted =
      std::count_if(pairs.begin(), pairs.end(), [](const PairAlignment& p) { return p.trusted; });
  std::string text = fmt::format("{} of {} scans are connected by {} trusted of {} tried pairs",
                                 connected_count(), names.size(), trusted, pairs.size());
  for (size_t i = 0; i < names.size(); ++i) {
    if (connected[i]) continue;
    text += fmt::format("\n{} has no trusted connection and stands by odometry only", names[i]);
    for (const PairAlignment& pair : pairs)
      if (!pair.trusted && (pair.source == i || pair.target == i))
        text +=
            fmt::format("; with {}: {}", names[pair.source == i ? pair.target : pair.source], pair.reason);
  }
  return text;
}

Json RegistrationResult::report() const {
  Json scans = Json::array();
  for (size_t i = 0; i < names.size(); ++i)
    scans.push_back({{"name", names[i]},
                     {"connected", static_cast<bool>(connected[i])},
                     {"placed_by", i == 0         ? "definition"
                                   : connected[i] ? "registration"
                                                  : "odometry"},
                     {"map_from_scan", values_from_pose(map_from_scan[i])}});
  Json list = Json::array();
  for (const PairAlignment& pair : pairs)
    list.push_back({{"target", names[pair.target]},
                    {"source", names[pair.source]},
                    {"trusted", pair.trusted},
                    {"reason", pair.reason},
                    {"overlap", pair.overlap},
                    {"rmse_m", pair.rmse_m},
                    {"degeneracy", pair.degeneracy},
                    {"conflict", pair.conflict},
                    {"target_from_source", values_from_pose(pair.target_from_source)}});
  return {{"usable", usable()},
          {"connected", connected_count()},
          {"scans", scans},
          {"pairs", list},
          {"seconds", seconds}};
}

}  // namespace loci::mapping
