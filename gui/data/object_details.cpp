#include "gui/data/object_details.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <map>

#include "gui/data/memory_index.h"
#include "gui/data/scene_content.h"
#include "mapping/base/math/math.h"
#include "mapping/base/text/json.h"
#include "memory/reasoning/why.h"

namespace loci::gui {
namespace {

constexpr size_t kMinBins = 4, kMaxBins = 1024;
constexpr size_t kSightingsLookedAt = 400;

std::string short_type(const std::string& type) {
  return type.substr(type.rfind('.') + 1);
}

/// In which of eight directions from the object the camera stood: 0 = east, counter-clockwise.
int side_of(const memory::SceneRow& scene, const memory::ObservationRow& seen) {
  if (!scene.map_from_camera || !seen.position) return -1;
  const Vector3d towards = scene.map_from_camera->translation() - *seen.position;
  return static_cast<int>(std::lround(std::atan2(towards.y(), towards.x()) / (kPi / 4)) + 8) % 8;
}

std::vector<ObjectImage> images_of(const memory::Store& store, const MemoryIndex& index,
                                   const std::vector<memory::ObjectObservation>& sightings) {
  // The map's axes: x is called east, as on a drawing.
  static constexpr std::array<const char*, 8> kSides = {"from +x", "from +x +y", "from +y", "from −x +y",
                                                        "from −x", "from −x −y", "from −y", "from +x −y"};
  std::map<int, const memory::ObjectObservation*> newest;  // by side
  for (const memory::ObjectObservation& sighting : sightings) {
    const memory::SceneRow* scene = index.scene(sighting.association.scene);
    if (sighting.observation.crop && scene != nullptr)
      newest[side_of(*scene, sighting.observation)] = &sighting;
  }
  std::vector<ObjectImage> images;
  for (const auto& [side, sighting] : newest)
    images.push_back({sighting->time, side < 0 ? "" : kSides[static_cast<size_t>(side)],
                      read_image(store, *sighting->observation.crop)});
  return images;
}

/// Every list of numbers in a feature structure.
void read_structure(const memory::FeatureStructureRow& row, ObjectDetails& details) {
  const Json json = parse_json(row.json, "feature_structure");
  for (const Json& structure : json.value("structures", Json::array())) {
    const Json features = structure.value("features", Json::object());
    const std::string type = short_type(structure.value("type", std::string()));
    for (const auto& [name, value] : features.items()) {
      if (!value.is_array() || value.size() < kMinBins || value.size() > kMaxBins || !value[0].is_number())
        continue;
      Histogram histogram{fmt::format("{}: {}", type, name), {}};
      for (const Json& bin : value) histogram.bins.push_back(bin.is_number() ? bin.get<double>() : 0);
      details.histograms.push_back(std::move(histogram));
    }
  }
}

std::string annotator_of(const memory::Store& store, const memory::AnnotationRow& row) {
  if (!row.feature_structure) return row.type == "loci.Label" ? "user" : "";
  const Json json = parse_json(store.feature_structure(*row.feature_structure).json, "feature_structure");
  for (const Json& structure : json.value("structures", Json::array()))
    if (structure.value("type", std::string()) == row.type)
      return structure.value("features", Json::object()).value("source", std::string());
  return "";
}

}  // namespace

ObjectDetails read_details(const memory::Store& store, const MemoryIndex& index, memory::Id object,
                           TimeNs time) {
  ObjectDetails details;
  std::vector<memory::ObjectObservation> sightings = store.observations_of(object, {time, std::nullopt});
  if (sightings.empty()) return details;
  if (sightings.size() > kSightingsLookedAt)
    sightings.erase(sightings.begin(), sightings.end() - static_cast<ptrdiff_t>(kSightingsLookedAt));
  details.images = images_of(store, index, sightings);
  const memory::ObjectObservation& last = sightings.back();
  for (const memory::AnnotationRow& row : store.annotations(last.association.scene))
    if (row.observation == last.observation.id && !row.value.empty())
      details.annotations.push_back(
          {short_type(row.type), row.value, annotator_of(store, row), row.confidence});
  for (const memory::FeatureStructureRow& row : store.feature_structures(last.association.scene))
    if (row.observation == last.observation.id) read_structure(row, details);
  try {
    details.why = why_object(store, object, {time, std::nullopt}).text;
  } catch (const Error& error) {  // of scenes without stored reasoning
    details.why = error.what();
  }
  return details;
}

}  // namespace loci::gui
