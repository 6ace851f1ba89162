#include "memory/catalogue/looks.h"

#include <algorithm>

namespace loci::memory {

void drop_words(Looks& looks) {
  for (auto& look : looks)
    std::erase_if(look, [](const belief::Descriptor& d) { return d.kind == "class" || d.kind == "text"; });
}

Looks LooksOfObjects::of(Id object) {
  constexpr size_t kMax = 6;
  std::vector<const belief::Observation*> seen;
  for (const ObjectObservation& sighting : store_.observations_of(object))
    if (const belief::Observation* one = evidence(sighting.observation);
        one != nullptr && !one->descriptors.empty())
      seen.push_back(one);
  const auto is_part = [](const belief::Observation* one) { return one->partial; };
  if (!std::ranges::all_of(seen, is_part)) std::erase_if(seen, is_part);
  Looks looks;
  const size_t count = std::min(kMax, seen.size());
  for (size_t i = 0; i < count; ++i) looks.push_back(seen[i * seen.size() / count]->descriptors);
  drop_words(looks);
  return looks;
}

const belief::Observation* LooksOfObjects::evidence(const ObservationRow& row) {
  const auto [slot, fresh] = scenes_.try_emplace(row.scene);
  if (fresh) slot->second = load_reasoning(store_, row.scene);
  const auto number = static_cast<size_t>(row.number);
  if (!slot->second || number >= slot->second->evidence.observations.size()) return nullptr;
  return &slot->second->evidence.observations[number];
}

}  // namespace loci::memory
