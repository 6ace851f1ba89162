#include "memory/ingest/detection_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <opencv2/core.hpp>

#include "mapping/base/math/polygon.h"
#include "mapping/base/text/json.h"
#include "mapping/image/hsv.h"
#include "mapping/world/semantic_map.h"
#include "memory/recorder/observation_pixels.h"
#include "memory/store/map_places.h"

namespace loci::memory {
namespace {

/// Assumed extent of a detection without size, to test whether it is in view.
constexpr double kAssumedSize_m = 0.1;
/// A detection stands on a support if its bottom is this near to it.
constexpr double kOnSupport_m = 0.1;

/// "table_1" is a table.
std::string class_of_name(const std::string& name) {
  const size_t end = name.find_last_not_of("0123456789");
  return end == std::string::npos || name[end] != '_' || end == 0 ? name : name.substr(0, end);
}

/// The support of the map under a detection; empty = none.
std::string support_under(const Detection& detection, const std::vector<PlaceRow>& places) {
  const double half_height = detection.size ? detection.size->z() / 2 : kAssumedSize_m / 2;
  const double bottom = detection.position.z() - half_height;
  const PlaceRow* best = nullptr;
  for (const PlaceRow& place : places) {
    if (!place.height || place.outline.size() < 3 || std::abs(bottom - *place.height) > kOnSupport_m)
      continue;
    if (!contains(place.outline, detection.position.head<2>())) continue;
    if (best == nullptr || std::abs(bottom - *place.height) < std::abs(bottom - *best->height)) best = &place;
  }
  return best == nullptr ? std::string() : best->name;
}

belief::Descriptor named(const std::string& kind, const std::vector<std::pair<std::string, double>>& parts) {
  belief::Descriptor descriptor{kind, {}, {}};
  for (const auto& [name, value] : parts) {
    descriptor.names.push_back(name);
    descriptor.values.push_back(static_cast<float>(value));
  }
  return descriptor;
}

std::vector<belief::Descriptor> descriptors_of(const Detection& detection) {
  std::vector<belief::Descriptor> descriptors;
  if (detection.color) {
    const Vector3d& hsv = *detection.color;
    const auto rgb = mapping::rgb_from_hsv(hsv[0], hsv[1], hsv[2]);
    descriptors.push_back({"mean_color", {rgb.begin(), rgb.end()}});
  }
  if (detection.size) {
    const Eigen::Vector3f size = detection.size->cast<float>();
    descriptors.push_back({"extents", {size.x(), size.y(), size.z()}});
  }
  if (!detection.classes.empty()) {
    double rest = 1;
    for (const auto& [name, probability] : detection.classes) rest -= probability;
    belief::Descriptor classes = named("class", detection.classes);
    if (rest > 0.01) {
      classes.names.emplace_back();  // any other
      classes.values.push_back(static_cast<float>(rest));
    }
    descriptors.push_back(std::move(classes));
  }
  if (!detection.texts.empty()) {
    std::vector<std::pair<std::string, double>> texts;
    for (const std::string& text : detection.texts) texts.emplace_back(text, 1.0);
    descriptors.push_back(named("text", texts));
  }
  for (const auto& [name, values] : detection.features) descriptors.push_back({name, values});
  return descriptors;
}

void annotate(const Detection& detection, ObservationRecord& observation) {
  const auto add = [&](const char* type, const std::string& value, std::optional<double> confidence) {
    observation.annotations.push_back({type, value, confidence, {}});
  };
  for (const auto& [name, probability] : detection.classes)
    add("loci.annotation.ClassificationAnnotation", name, probability);
  for (const std::string& text : detection.texts) add("loci.annotation.TextAnnotation", text, std::nullopt);
  // Without a value: by that people name objects.
  if (detection.score) add("loci.hypothesis.ObjectHypothesis", "", detection.score);
  for (const perception::KeyPoint3D& point : detection.lifted_points)
    add("loci.hypothesis.KeyPoint",
        fmt::format("{} {:.3f} {:.3f} {:.3f}", point.name, point.position.x(), point.position.y(),
                    point.position.z()),
        std::nullopt);
}

ObservationRecord observation_of(const Detection& detection, double sigma_m,
                                 const std::vector<PlaceRow>& places, SceneRecord& record) {
  const std::optional<Isometry3d>& map_from_camera = record.row.map_from_camera;
  ObservationRecord observation;
  if (!detection.pixels.empty()) set_pixels(detection.pixels, record, observation);
  belief::Observation& evidence = observation.evidence;
  evidence.partial = detection.at_image_border;
  evidence.box = {detection.position, detection.size.value_or(Vector3d::Constant(kAssumedSize_m))};
  evidence.has_size = detection.size.has_value();
  evidence.sigma_m = detection.position_sigma.value_or(sigma_m);
  if (map_from_camera) evidence.range = (map_from_camera->inverse() * detection.position).z();
  evidence.place = detection.place.empty() ? support_under(detection, places) : detection.place;
  evidence.descriptors = descriptors_of(detection);
  observation.row.position = detection.position;
  observation.row.size = detection.size;
  if (detection.color) {
    const Vector3d& hsv = *detection.color;
    observation.row.hsv = HsvColor{hsv[0], hsv[1], hsv[2]};
    observation.row.color = mapping::color_name(static_cast<float>(hsv[0]), static_cast<float>(hsv[1]),
                                                static_cast<float>(hsv[2]));
  }
  annotate(detection, observation);
  return observation;
}

void read_camera(const DetectedScene& scene, SceneRecord& record) {
  belief::SceneView& view = record.view;
  view.has_camera = scene.camera && scene.camera->map_from_camera && scene.camera->lens;
  if (!scene.camera) return;
  const DetectedScene::Camera& camera = *scene.camera;
  record.row.map_from_camera = camera.map_from_camera;
  if (camera.map_from_camera) view.map_from_camera = *camera.map_from_camera;
  view.near_m = camera.near_m.value_or(view.near_m);
  view.far_m = camera.far_m.value_or(view.far_m);
  if (!camera.lens) return;
  view.camera = *camera.lens;
  record.row.camera = SceneCamera{view.camera.width, view.camera.height, view.camera.fx, view.camera.fy,
                                  view.camera.cx,    view.camera.cy,     camera.near_m,  camera.far_m};
}

/// What the camera of the recording measured: it decides what was seen empty, and what was hidden.
void read_frame(const DetectedScene& scene, SceneRecord& record) {
  if (!scene.frame) return;
  record.view.depth = scene.frame->depth;
  record.view.map_depth = scene.map_depth;
  record.view.labels = cv::Mat(scene.frame->depth.size(), CV_32S, cv::Scalar(-1));
  record.row.joints = scene.frame->joints;
  record.cameras = scene.frame->camera;
  if (!scene.frame->color.empty()) record.image = {encoded_image(scene.frame->color, ".jpg"), "image/jpeg"};
}

void add_place(const std::string& name, const std::vector<PlaceRow>& map_places, SceneRecord& record) {
  const auto same = [&](const PlaceRow& place) { return place.name == name; };
  if (name.empty() || std::ranges::any_of(record.places, same)) return;
  const auto known = std::ranges::find_if(map_places, same);
  if (known != map_places.end())
    record.places.push_back(*known);
  else
    record.places.push_back({.name = name, .class_name = class_of_name(name)});
}

}  // namespace

SceneRecord detections_to_scene(const DetectedScene& scene, double sigma_m,
                                const std::vector<PlaceRow>& map_places) {
  SceneRecord record;
  record.source = "ingest";
  record.row.time = scene.time;
  read_camera(scene, record);
  read_frame(scene, record);
  if (scene.observed) {
    record.view.observed.emplace();
    for (const auto& [place, fraction] : *scene.observed) {
      record.view.observed->push_back({place, fraction});
      add_place(place, map_places, record);
    }
  }
  for (const Detection& detection : scene.detections) {
    record.observations.push_back(observation_of(detection, sigma_m, map_places, record));
    add_place(record.observations.back().evidence.place, map_places, record);
  }
  return record;
}

std::vector<PlaceRow> places_of_map(const std::filesystem::path& urdf) {
  std::vector<PlaceRow> places;
  const std::filesystem::path sidecar = mapping::sidecar_path(urdf);
  if (!std::filesystem::exists(sidecar)) return places;
  for (const auto& [name, link] : mapping::read_semantic_map(sidecar).links)
    if (auto place = place_of_link(name, link, sidecar.string())) places.push_back(std::move(*place));
  return places;
}

}  // namespace loci::memory
