#include "memory/recorder/map_entry.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "mapping/base/files.h"
#include "mapping/base/text/json.h"
#include "mapping/base/text/text.h"
#include "mapping/world/semantic_map.h"
#include "mapping/world/urdf.h"
#include "memory/recorder/checkpoint.h"
#include "memory/recorder/recorder.h"

namespace loci::memory {

namespace {

/// A wall of a map's sidecar in plan.
struct Wall {
  Vector2d normal = Vector2d::UnitX();
  double offset = 0;
  Vector2d middle = Vector2d::Zero();

  /// Maps of one room may have either face of a wall, from either side.
  bool is_along(const Wall& other) const {
    constexpr double kThickness_m = 0.3, kMinCosine = 0.98;
    return std::abs(normal.dot(other.normal)) > kMinCosine &&
           std::abs(normal.dot(other.middle) - offset) < kThickness_m;
  }
};

std::vector<Wall> walls_of(const std::string& sidecar, const std::string& file) {
  std::vector<Wall> walls;
  if (sidecar.empty()) return walls;
  for (const auto& [name, link] : mapping::semantic_map_from_json(parse_json(sidecar, file), file).links) {
    const Json& geometry = link.geometry;
    if (link.class_name != "wall" || !geometry.is_object() || !geometry.contains("outline") ||
        !geometry.contains("normal") || !geometry.contains("offset"))
      continue;
    const auto plan = [](const Json& json) {
      return Vector2d(json.at(0).get<double>(), json.at(1).get<double>());
    };
    Wall& wall = walls.emplace_back();
    wall.normal = plan(geometry.at("normal"));
    wall.offset = geometry.at("offset").get<double>();
    for (const Json& corner : geometry.at("outline"))
      wall.middle += plan(corner) / static_cast<double>(geometry.at("outline").size());
  }
  return walls;
}

size_t number_along(const std::vector<Wall>& walls, const std::vector<Wall>& others) {
  return static_cast<size_t>(std::ranges::count_if(walls, [&](const Wall& wall) {
    return std::ranges::any_of(others, [&](const Wall& other) { return other.is_along(wall); });
  }));
}

/// Error where a map shows other walls than the last map of the memory: all of one of them may be in a part
/// of the other.
void require_same_room(const Store& store, const std::filesystem::path& urdf, const std::string& sidecar) {
  const std::vector<MapRow> maps = store.maps();
  if (maps.empty() || !maps.back().sidecar) return;
  const std::vector<Wall> before = walls_of(store.blob(*maps.back().sidecar).bytes, store.name()),
                          now = walls_of(sidecar, mapping::sidecar_path(urdf).string());
  const size_t common = number_along(now, before);
  if (before.empty() || now.empty() || 2 * common > now.size() ||
      2 * number_along(before, now) > before.size())
    return;
  throw Error(fmt::format("is the map of another room than map '{}' of {}: {} of its {} stand where that one "
                          "has walls",
                          maps.back().name, store.name(), common, counted(now.size(), "wall")),
              {urdf.string(), 0, {}},
              "use one memory per home, whose maps have one frame; loci-map update keeps the frame of a map");
}

}  // namespace

Id add_map(Store& store, const std::filesystem::path& urdf) {
  const std::filesystem::path sidecar = mapping::sidecar_path(urdf);
  if (std::filesystem::exists(sidecar)) require_same_room(store, urdf, read_file(sidecar));
  return store.add_map(urdf.filename().string(), read_file(urdf),
                       std::filesystem::exists(sidecar) ? read_file(sidecar) : std::string());
}

std::vector<MapPeriod> map_periods(const Store& store) {
  std::vector<MapPeriod> periods;
  const std::vector<MapRow> maps = store.maps();
  const std::vector<PlaceRow> places = store.places();
  PlaceMotions motions(store);
  for (const SceneRow& scene : store.scenes()) {
    if (!scene.map) continue;
    if (periods.empty() || periods.back().map != *scene.map) {
      MapPeriod period{.map = *scene.map, .from = scene.time};
      for (const MapRow& row : maps)
        if (row.id == period.map) period.name = row.name;
      if (!periods.empty())
        for (const PlaceRow& place : places)
          if (is_moved(motions.motion(place, periods.back().map, period.map)))
            period.moved.push_back(place.name);
      periods.push_back(std::move(period));
    }
    ++periods.back().scenes;
  }
  return periods;
}

void enter_map(Store& store, const std::filesystem::path& urdf, TimeNs at, const std::string& program) {
  mapping::parse_urdf(read_file(urdf), urdf.string());  // to refuse what is none before anything is written
  const std::optional<SceneRow> last = store.last_scene();
  if (!last)
    throw store.error("this memory has no scene yet", "perceive with --map " + urdf.filename().string());
  if (at <= last->time)
    throw store.error(
        fmt::format("there are scenes after {}, perceived with another map", format_time(at)),
        fmt::format("give a time after {}, or perceive the later recordings again with this map",
                    format_time(last->time)));
  const Id map = add_map(store, urdf);
  if (map == last->map) return;
  SceneRecord record;
  record.row.time = at;
  record.row.joints = last->joints;
  record.row.map = map;
  record.view.has_camera = false;
  record.view.observed.emplace();
  const Id run = store.begin_run(program, Json{{"map", urdf.filename().string()}}.dump());
  Recorder(store, run, load_options(store)).record(record);
  store.finish_run(run);
}

}  // namespace loci::memory
