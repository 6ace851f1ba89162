#include "memory/recorder/map_entry.h"

#include <fmt/format.h>

#include "mapping/base/files.h"
#include "mapping/base/text/json.h"
#include "mapping/world/semantic_map.h"
#include "mapping/world/urdf.h"
#include "memory/recorder/checkpoint.h"
#include "memory/recorder/recorder.h"

namespace loci::memory {

Id add_map(Store& store, const std::filesystem::path& urdf) {
  const std::filesystem::path sidecar = mapping::sidecar_path(urdf);
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
