#include "gui/data/memory_index.h"

#include <fmt/format.h>

#include <algorithm>

#include "mapping/base/json.h"
#include "memory/questions/events.h"
#include "memory/questions/map_names.h"

namespace loci::gui {
namespace {

constexpr size_t kKnownStates = 30;

void read_names(const memory::Store& store, MemoryIndex& index) {
  index.parts = part_names(store);
  for (const memory::PlaceRow& place : named_places(store)) index.places[place.id] = place.name;
  for (const memory::FactRow& fact : store.facts()) {
    if (!fact.object || !fact.value) continue;
    if (fact.key == "alias") index.aliases[*fact.object] = *fact.value;
    if (fact.key == "owner") index.owners[*fact.object] = *fact.value;
    if (fact.key == "class") index.classes[*fact.object] = *fact.value;
  }
}

void add_scene(const memory::SceneRow& row, MemoryIndex& index) {
  const std::string name =
      row.frame_index ? fmt::format("frame {}", *row.frame_index) : fmt::format("scene {}", row.id);
  index.number_of_scene[row.id] = index.scenes.size();
  index.scenes.push_back({row.id, row.time, name, row.map_from_camera});
  index.last_scene = std::max(index.last_scene, row.id);
}

void add_events(const memory::Store& store, std::optional<TimeNs> from, MemoryIndex& index) {
  for (const memory::Change& change : ask(store, memory::ChangesQuestion{.from = from}).changes)
    index.events.push_back(
        {change.time, memory::to_text(change.kind), change.object ? change.object->id : 0, to_text(change)});
  std::stable_sort(index.events.begin(), index.events.end(),
                   [](const EventEntry& a, const EventEntry& b) { return a.time < b.time; });
}

/// Takes over the scenes and events of before and adds those behind them; false when something else than
/// further scenes at the end may have come.
bool grow(const memory::Store& store, const MemoryIndex& before, MemoryIndex& index) {
  if (before.info.runs != index.info.runs || before.scenes.empty()) return false;
  const TimeNs end = before.scenes.back().time;
  const std::vector<memory::SceneRow> later = store.scenes({}, end + 1);
  const std::optional<memory::SceneRow> newest = store.last_scene();
  if (!newest || newest->id - before.last_scene != static_cast<memory::Id>(later.size())) return false;
  index.scenes = before.scenes;
  index.number_of_scene = before.number_of_scene;
  index.last_scene = before.last_scene;
  index.events = before.events;
  for (const memory::SceneRow& row : later) add_scene(row, index);
  add_events(store, end + 1, index);
  return true;
}

void read_places(const memory::Store& store, const MemoryIndex* before, MemoryIndex& index) {
  if (before != nullptr && before->world && before->info.runs == index.info.runs)
    index.world = before->world;
  else if (auto map = named_map(store))
    index.world = std::make_shared<const mapping::World>(std::move(*map));
  for (const memory::PlaceRow& place : named_places(store))
    if (place.height && place.outline.size() > 2 &&
        !(index.world && index.world->find_link(place.name) != nullptr))
      index.loose_places.push_back({place.name, place.outline, *place.height});
}

/// Only the last ones: who goes further back than that asks the command line.
std::vector<KnownState> known_states(const memory::Store& store) {
  std::vector<KnownState> states;
  const std::vector<memory::RunRow> runs = store.runs();
  for (size_t i = runs.size() - std::min(runs.size(), kKnownStates); i < runs.size(); ++i) {
    if (i == 0) continue;  // before the first one nothing was known
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
  info.runs = index.info.runs;
  info.known = known_states(store);
  info.path = store.path().string();
  info.schema = fmt::format("{}.{}", store.major(), store.minor());
  info.zone_minutes = store.time_zone_minutes();
  for (const memory::RecordingRow& recording : store.recordings())
    info.time_assumed |= recording.time_assumed;
  const auto plural = [](size_t n, const char* what) {
    return fmt::format("{} {}{}", n, what, n == 1 ? "" : "s");
  };
  info.summary = fmt::format("{} · {} · {}", plural(index.scenes.size(), "scene"),
                             plural(store.objects().size(), "object"), plural(index.events.size(), "event"));
  if (!index.world) info.summary += " · no map";
  return info;
}

}  // namespace

const std::string* MemoryIndex::name_of_place(std::optional<memory::Id> id) const {
  const auto found = id ? places.find(*id) : places.end();
  return found == places.end() ? nullptr : &found->second;
}

std::string MemoryIndex::name_of(memory::Id object) const {
  const auto alias = aliases.find(object);
  return alias == aliases.end() ? memory::object_name(object) : alias->second;
}

MemoryIndex read_index(const memory::Store& store, const MemoryIndex* before, Progress& progress) {
  MemoryIndex index;
  index.info.runs = store.runs().size();
  progress.check(0.1, "reading scenes");
  read_names(store, index);
  if (before == nullptr || !grow(store, *before, index)) {
    for (const memory::SceneRow& row : store.scenes()) add_scene(row, index);
    progress.check(0.4, "reading events");
    add_events(store, {}, index);
  }
  progress.check(0.9, "reading the map");
  read_places(store, before, index);
  index.info = describe(store, index);
  return index;
}

}  // namespace loci::gui
