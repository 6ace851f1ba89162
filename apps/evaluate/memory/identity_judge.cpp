#include "apps/evaluate/memory/identity_judge.h"

#include <fmt/format.h>

#include <algorithm>

#include "mapping/base/text/json.h"

namespace loci::apps::memory_experiment {

double IdentityFigures::f1() const {
  return visible + attributed == 0 ? 0.0 : 2 * double(agreed) / double(visible + attributed);
}

void IdentityJudge::see(const std::vector<JudgedSighting>& scene) {
  for (const JudgedSighting& sighting : scene) {
    IdentityFigures::Event& event = figures_.events[static_cast<size_t>(sighting.event)];
    ++event.all;
    event.said_moved += sighting.moved ? 1 : 0;
    figures_.attributed += sighting.object != 0 ? 1 : 0;
    figures_.visible += sighting.thing >= 0 ? 1 : 0;
    const auto before = object_of_.find(sighting.thing);
    const bool known = sighting.thing >= 0 && before != object_of_.end();
    if (sighting.object == 0) continue;
    if (sighting.appeared)
      event.split += known ? 1 : 0;
    else if (known ? before->second == sighting.object : !owned_.contains(sighting.object))
      ++event.same;
    else
      ++event.confused;
    ++common_[{sighting.thing, sighting.object}];
  }
  for (const JudgedSighting& sighting : scene)
    if (sighting.object != 0) {
      owned_.insert(sighting.object);
      if (sighting.thing >= 0) object_of_[sighting.thing] = sighting.object;
    }
}

IdentityFigures IdentityJudge::figures() const {
  IdentityFigures result = figures_;
  std::set<int> things;
  std::map<int64_t, std::pair<size_t, size_t>> sightings;  // of each object: all, of its commonest thing
  std::vector<std::pair<size_t, std::pair<int, int64_t>>> order;
  for (const auto& [pair, count] : common_) {
    if (pair.first >= 0) things.insert(pair.first);
    auto& [all, most] = sightings[pair.second];
    all += count;
    most = std::max(most, count);
    if (pair.first >= 0) order.push_back({count, pair});
  }
  result.things = things.size();
  result.objects = sightings.size();
  for (const auto& [object, counts] : sightings)
    result.merged += 10 * (counts.first - counts.second) >= counts.first ? 1 : 0;
  // The most sightings in common first, each once.
  std::stable_sort(order.begin(), order.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  std::set<int> paired;
  std::set<int64_t> taken;
  for (const auto& [count, pair] : order) {
    if (paired.contains(pair.first) || taken.contains(pair.second)) continue;
    paired.insert(pair.first);
    taken.insert(pair.second);
    result.agreed += count;
  }
  return result;
}

std::string text_of(const IdentityFigures& f) {
  std::string text = fmt::format(
      "  identity: {} true objects, {} remembered objects, {} of them of several true objects; identity F1 "
      "{:.3f}\n"
      "  {:22} {:>7} {:>10} {:>10} {:>13} {:>10}\n",
      f.things, f.objects, f.merged, f.f1(), "since it was seen last", "all", "same", "new object",
      "another's", "\"moved\"");
  for (size_t i = 0; i < kTrueEvents; ++i) {
    const IdentityFigures::Event& e = f.events[i];
    text += fmt::format("  {:22} {:7} {:10} {:10} {:13} {:10}\n", true_event_name(i), e.all, e.same, e.split,
                        e.confused, e.said_moved);
  }
  return text;
}

Json json_of(const IdentityFigures& f) {
  Json json = {{"things", f.things},
               {"objects", f.objects},
               {"merged", f.merged},
               {"f1", f.f1()},
               {"events", Json::object()}};
  for (size_t i = 0; i < kTrueEvents; ++i) {
    const IdentityFigures::Event& e = f.events[i];
    json["events"][true_event_name(i)] = {{"all", e.all},
                                          {"same", e.same},
                                          {"new_object", e.split},
                                          {"another_object", e.confused},
                                          {"said_moved", e.said_moved}};
  }
  return json;
}

const char* true_event_name(size_t event) {
  static constexpr const char* kNames[] = {"stayed", "moved on its table", "moved to another table", "new",
                                           "false detection"};
  return kNames[event];
}

}  // namespace loci::apps::memory_experiment
