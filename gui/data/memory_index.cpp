#include "gui/data/memory_index.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "mapping/base/text/json.h"
#include "memory/questions/events.h"
#include "memory/questions/names/map_names.h"
#include "memory/questions/snapshot.h"

namespace loci::gui {
namespace {

constexpr size_t kKnownStates = 30;  // earlier ones are asked for on the command line

std::string value_or_empty(const std::map<memory::Id, std::string>& values, memory::Id id) {
  const auto found = values.find(id);
  return found == values.end() ? std::string() : found->second;
}

std::shared_ptr<const Names> read_names(const memory::Store& store,
                                        const std::vector<memory::PlaceRow>& places) {
  auto names = std::make_shared<Names>();
  names->parts = part_names(store);
  for (const memory::PlaceRow& place : places) {
    names->places[place.id] = place.name;
    if (place.joint) names->joint_of_place[place.id] = names->parts.joint(*place.joint);
  }
  std::map<memory::Id, std::string> aliases;  // the latest
  for (const memory::FactRow& fact : store.facts()) {
    if (!fact.object || !fact.value) continue;
    if (fact.key == "alias") aliases[*fact.object] = *fact.value;
    if (fact.key == "owner") names->owners[*fact.object] = *fact.value;
    if (fact.key == "class") names->classes[*fact.object] = *fact.value;
  }
  // What several objects look like gets their number behind it; what somebody named is called so.
  const memory::Snapshot now(store, {});
  names->believed = now.beliefs().size();
  std::map<std::string, int> count;
  for (const memory::BeliefRow& belief : now.beliefs())
    if (const auto label = now.object_ref(belief.object).label)
      ++count[names->labels[belief.object] = *label];
  for (auto& [object, label] : names->labels)
    if (count[label] > 1) label += " (" + memory::object_name(object) + ")";
  for (const auto& [object, alias] : aliases) names->labels[object] = alias;
  return names;
}

void add_scenes(std::vector<memory::SceneRow> rows, MemoryIndex& index) {
  for (memory::SceneRow& row : rows) {
    index.number_of_scene[row.id] = index.scenes.size();
    index.last_scene = std::max(index.last_scene, row.id);
    index.scenes.push_back(std::move(row));
  }
}

void add_events(const memory::Store& store, std::optional<TimeNs> from, MemoryIndex& index) {
  for (memory::Change& change : ask(store, memory::ChangesQuestion{.from = from}).changes)
    index.events.push_back(std::move(change));
  std::stable_sort(index.events.begin(), index.events.end(),
                   [](const memory::Change& a, const memory::Change& b) { return a.time < b.time; });
}

/// Takes over the scenes and events of before and adds later ones; false when something else than further
/// scenes at the end may have come.
bool grow(const memory::Store& store, const MemoryIndex& before, MemoryIndex& index) {
  if (before.info.runs != index.info.runs || before.scenes.empty()) return false;
  const TimeNs end = before.scenes.back().time;
  std::vector<memory::SceneRow> later = store.scenes({}, end + 1);
  const std::optional<memory::SceneRow> newest = store.last_scene();
  if (!newest || newest->id - before.last_scene != static_cast<memory::Id>(later.size())) return false;
  index.scenes = before.scenes;
  index.number_of_scene = before.number_of_scene;
  index.last_scene = before.last_scene;
  index.events = before.events;
  add_scenes(std::move(later), index);
  add_events(store, end + 1, index);
  return true;
}

/// One for each period in which the scenes have the same map.
std::map<TimeNs, std::shared_ptr<const mapping::World>> read_worlds(
    const memory::Store& store, const std::vector<memory::SceneRow>& scenes) {
  std::map<TimeNs, std::shared_ptr<const mapping::World>> worlds;
  std::optional<memory::Id> map;
  const auto add = [&](TimeNs time) {
    if (auto world = named_map(store, {.at = time}))
      worlds[time] = std::make_shared<const mapping::World>(std::move(*world));
  };
  for (const memory::SceneRow& scene : scenes)
    if (scene.map && scene.map != std::exchange(map, scene.map)) add(scene.time);
  if (worlds.empty() && !scenes.empty()) add(scenes.front().time);
  return worlds;
}

void read_map(const memory::Store& store, const std::vector<memory::PlaceRow>& places,
              const MemoryIndex* before, MemoryIndex& index) {
  if (before != nullptr && before->info.runs == index.info.runs)
    index.worlds = before->worlds;
  else
    index.worlds = read_worlds(store, index.scenes);
  const auto draws = [&](const std::string& place) {
    return std::ranges::any_of(index.worlds,
                               [&](const auto& one) { return one.second->find_link(place) != nullptr; });
  };
  for (const memory::PlaceRow& place : places)
    if (place.height && place.outline.size() > 2 && !draws(place.name)) index.loose_places.push_back(place);
}

std::vector<KnownState> known_states(const std::vector<memory::RunRow>& runs) {
  std::vector<KnownState> states;
  for (size_t i = runs.size() - std::min(runs.size(), kKnownStates); i < runs.size(); ++i) {
    if (i == 0) continue;  // before the first run nothing was known
    const Json configuration = parse_json(runs[i].configuration, "run.configuration");
    std::string what = runs[i].program;
    if (configuration.is_object() && configuration.contains("text") && configuration["text"].is_string())
      what = configuration["text"].get<std::string>();
    states.push_back({runs[i].started - 1, "before: " + what});
  }
  return states;
}

MemoryInfo describe(const memory::Store& store, const MemoryIndex& index) {
  MemoryInfo info;
  const std::vector<memory::RunRow> runs = store.runs();
  info.runs = index.info.runs;
  info.known = known_states(runs);
  info.path = store.path().string();
  info.schema = fmt::format("{}.{}", store.major(), store.minor());
  info.zone = store.time_zone();
  for (const memory::RecordingRow& recording : store.recordings())
    info.time_assumed |= recording.time_assumed;
  const auto plural = [](size_t n, const char* what) {
    return fmt::format("{} {}{}", n, what, n == 1 ? "" : "s");
  };
  info.summary = fmt::format("{} · {} · {}", plural(index.scenes.size(), "scene"),
                             plural(index.names->believed, "object"), plural(index.events.size(), "event"));
  if (index.worlds.empty()) info.summary += " · no map";
  return info;
}

}  // namespace

std::string Names::object(memory::Id id) const {
  const auto label = labels.find(id);
  return label == labels.end() ? memory::object_name(id) : label->second;
}

std::string Names::class_of(memory::Id object) const {
  return value_or_empty(classes, object);
}

std::string Names::owner_of(memory::Id object) const {
  return value_or_empty(owners, object);
}

std::string Names::place(const std::optional<memory::Id>& id) const {
  return id ? value_or_empty(places, *id) : std::string();
}

const memory::SceneRow* MemoryIndex::scene(const std::optional<memory::Id>& id) const {
  const auto found = id ? number_of_scene.find(*id) : number_of_scene.end();
  return found == number_of_scene.end() ? nullptr : &scenes[found->second];
}

MemoryIndex read_index(const memory::Store& store, const MemoryIndex* before, Progress& progress) {
  MemoryIndex index;
  index.info.runs = store.runs().size();
  progress.check(0.1, "reading scenes");
  const std::vector<memory::PlaceRow> places = named_places(store);
  index.names = read_names(store, places);
  if (before == nullptr || !grow(store, *before, index)) {
    add_scenes(store.scenes(), index);
    progress.check(0.4, "reading events");
    add_events(store, {}, index);
  }
  progress.check(0.9, "reading the map");
  read_map(store, places, before, index);
  index.info = describe(store, index);
  return index;
}

}  // namespace loci::gui
