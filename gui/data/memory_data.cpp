#include "gui/data/memory_data.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <mutex>
#include <opencv2/imgproc.hpp>
#include <unordered_map>

#include "gui/data/decisions.h"
#include "gui/data/memory_index.h"
#include "gui/data/object_details.h"
#include "gui/data/scene_content.h"
#include "memory/exchange/observation_image.h"
#include "memory/questions/location.h"
#include "memory/questions/snapshot.h"
#include "memory/questions/time_parser.h"
#include "memory/store/feature_structures.h"
#include "memory/store/scene_images.h"
#include "memory/store/store.h"
#include "perception/types/geometry.h"
#include "perception/types/types.h"

namespace loci::gui {
namespace {

Presence presence_of(memory::ObjectStatus status) {
  if (status == memory::ObjectStatus::seen) return Presence::seen;
  if (status == memory::ObjectStatus::missed) return Presence::missed;
  if (status == memory::ObjectStatus::hidden) return Presence::hidden;
  if (status == memory::ObjectStatus::gone) return Presence::gone;
  return Presence::remembered;
}

std::array<uint8_t, 3> rgb_of(const memory::HsvColor& hsv) {
  const double chroma = hsv.value * hsv.saturation;
  const auto channel = [&](double shift) {
    const double k = std::fmod(shift + hsv.hue / 60, 6);
    const double level = hsv.value - chroma * std::clamp(std::min(k, 4 - k), 0.0, 1.0);
    return static_cast<uint8_t>(std::lround(std::clamp(level, 0.0, 1.0) * 255));
  };
  return {channel(5), channel(3), channel(1)};
}

mapping::PinholeCamera pinhole_of(const memory::SceneCamera& camera) {
  return {camera.width, camera.height, camera.fx, camera.fy, camera.cx, camera.cy};
}

double distance_of(const std::optional<Vector3d>& position, const SceneContent& content) {
  double z = 1;
  if (position && content.map_from_camera) z = (content.map_from_camera->inverse() * *position).z();
  return std::max(z, 0.1);
}

/// Where a part of the depth image is in the colour image, at the distance of what it shows.
cv::Rect2d in_color_image(const cv::Rect2d& roi, const std::optional<Vector3d>& position,
                          const SceneContent& content) {
  const mapping::RgbdCamera& camera = content.camera;
  const Isometry3d color_from_depth = camera.depth_from_color.inverse();
  const double z = distance_of(position, content);
  Eigen::AlignedBox2d area;
  for (const auto& [u, v] : {std::pair(roi.x, roi.y), std::pair(roi.x + roi.width, roi.y + roi.height)})
    area.extend(camera.color.project(color_from_depth * camera.depth.unproject(u, v, z)));
  return {area.min().x(), area.min().y(), area.sizes().x(), area.sizes().y()};
}

cv::Mat read_mask(const memory::Store& store, memory::Id blob) {
  cv::Mat mask;
  cv::extractChannel(read_image(store, blob), mask, 0);
  return mask;
}

/// The mask's outlines as drawings over both images.
void add_outlines(const cv::Mat& mask, const std::optional<Vector3d>& position, const SceneContent& content,
                  ImageBox& box) {
  std::vector<std::vector<cv::Point>> contours;
  cv::findContours(mask, contours, cv::RETR_EXTERNAL, cv::CHAIN_APPROX_SIMPLE);
  const mapping::RgbdCamera& camera = content.camera;
  const Isometry3d color_from_depth = camera.depth_from_color.inverse();
  const double z = distance_of(position, content);
  for (const auto& contour : contours) {
    auto& in_depth = box.depth_outline.emplace_back();
    auto& in_color = box.color_outline.emplace_back();
    for (const cv::Point& pixel : contour) {
      const double u = pixel.x + box.depth.x, v = pixel.y + box.depth.y;
      const Vector2d there = camera.color.project(color_from_depth * camera.depth.unproject(u, v, z));
      in_depth.emplace_back(static_cast<float>(u), static_cast<float>(v));
      in_color.emplace_back(static_cast<float>(there.x()), static_cast<float>(there.y()));
    }
  }
}

class MemoryData : public BrowserData {
 public:
  MemoryData(const std::filesystem::path& path, const MemoryIndex* before, Progress& progress)
      : path_(path), store_(memory::Store::open_read(path)), index_(read_index(store_, before, progress)) {}

  const MemoryInfo& info() const override { return index_.info; }
  const std::vector<SceneEntry>& scenes() const override { return index_.scenes; }
  const std::vector<EventEntry>& events() const override { return index_.events; }
  const mapping::World* world() const override { return index_.world.get(); }
  const std::vector<PlaceOutline>& loose_places() const override { return index_.loose_places; }
  mapping::MeshSearch mesh_search() const override { return {{}, path_.parent_path()}; }

  std::unique_ptr<BrowserData> renewed(Progress& progress) const override {
    return std::make_unique<MemoryData>(path_, &index_, progress);
  }
  BelievedScene belief_at(TimeNs time, std::optional<TimeNs> known_at) const override;
  std::vector<SceneDecisions> decisions(int64_t scene, size_t count) const override;
  ObjectDetails details(int64_t object, TimeNs time) const override {
    const std::lock_guard lock(mutex_);
    return read_details(store_, index_, object, time);
  }
  SceneContent scene(int64_t id) const override;
  std::vector<ImageNote> notes(int64_t scene) const override {
    const std::lock_guard lock(mutex_);
    return image_notes(store_, scene);
  }
  std::vector<HistoryEntry> history(int64_t object) const override;
  std::vector<TimeNs> observations(int64_t object) const override;
  std::vector<TracePoint> trace(int64_t object) const override;
  ColoredCloud object_cloud(int64_t object, TimeNs time, std::optional<TimeNs> known_at) const override;
  std::vector<Look> looks_for_object(int64_t object, size_t first_scene) const override;
  std::vector<Look> looks_at_place(const std::string& place, size_t first_scene) const override;
  cv::Mat image(int64_t object, TimeNs time) const override;
  // A Store belongs to one thread at a time; a question may take long and gets one of its own.
  TypedAnswer answer(const TypedQuestion& question) const override {
    return gui::answer_question(memory::Store::open_read(path_), question);
  }
  std::vector<std::string> example_questions() const override {
    return loci::gui::example_questions(memory::Store::open_read(path_));
  }
  std::vector<std::string> known_words() const override {
    return loci::gui::known_words(memory::Store::open_read(path_));
  }
  TimeNs time_of(const std::string& text) const override;
  FoundThings find(const std::string& words, TimeNs time) const override;

 private:
  BelievedObject believed(const memory::BeliefRow& row) const;
  const memory::ObservationRow& observation(memory::Id id) const;
  mapping::RgbdCamera cameras_of(const memory::SceneRow& row) const;
  std::vector<ImageBox> boxes(const memory::SceneRow& row, const SceneContent& content) const;
  /// Calls `mark` with the place in `looks` of each scene that is in it.
  template <class Mark>
  void mark_scene(memory::Id scene, size_t first_scene, Mark mark) const {
    const auto found = index_.number_of_scene.find(scene);
    if (found != index_.number_of_scene.end() && found->second >= first_scene)
      mark(found->second - first_scene);
  }

  std::filesystem::path path_;
  mutable std::mutex mutex_;  ///< whoever reads from the store
  memory::Store store_;
  MemoryIndex index_;
  mutable std::unordered_map<memory::Id, memory::ObservationRow>
      observations_;  ///< read once, asked for at every step in time
};

const memory::ObservationRow& MemoryData::observation(memory::Id id) const {
  const auto found = observations_.find(id);
  return found != observations_.end() ? found->second
                                      : observations_.emplace(id, store_.observation(id)).first->second;
}

BelievedObject MemoryData::believed(const memory::BeliefRow& row) const {
  BelievedObject object;
  object.id = row.object;
  object.name = index_.name_of(row.object);
  if (const auto found = index_.classes.find(row.object); found != index_.classes.end())
    object.class_name = found->second;
  if (const auto found = index_.owners.find(row.object); found != index_.owners.end())
    object.owner = found->second;
  object.color_name = row.color.value_or("");
  if (const std::string* place = index_.name_of_place(row.place)) object.place = *place;
  object.presence = presence_of(row.status);
  object.probability = row.probability;
  object.size = row.size.value_or(Vector3d::Zero());
  if (row.hsv) object.rgb = rgb_of(*row.hsv);
  Isometry3d pose = Isometry3d::Identity();
  bool placed = false;
  if (row.last_observation) {  // The belief is a position; how the thing is turned, its last sight says.
    const memory::ObservationRow& seen = observation(*row.last_observation);
    if (seen.map_from_box) {
      pose = *seen.map_from_box;
      placed = true;
    }
    if (seen.size) object.size = *seen.size;
    if (row.position && seen.position && placed) pose.translation() += *row.position - *seen.position;
  }
  if (row.position && !placed) {
    pose.translation() = *row.position;
    placed = true;
  }
  if (placed) object.map_from_object = pose;
  if (row.last_scene)
    mark_scene(*row.last_scene, 0, [&](size_t number) { object.last_seen = index_.scenes[number].time; });
  return object;
}

BelievedScene MemoryData::belief_at(TimeNs time, std::optional<TimeNs> known_at) const {
  const std::lock_guard lock(mutex_);
  BelievedScene belief;
  belief.time = time;
  const SceneEntry* entry = scene_at(time);
  if (entry != nullptr && entry->time <= time)
    for (const auto& [joint, position] : store_.scene(entry->id).joints)
      belief.joints[index_.parts.joint(joint)] = position;
  for (const memory::BeliefRow& row : store_.beliefs({time, known_at})) {
    belief.objects.push_back(believed(row));
    // A belief holds until the next one: what an earlier scene saw is remembered now.
    BelievedObject& object = belief.objects.back();
    if (object.presence == Presence::seen && entry != nullptr && object.last_seen != entry->time)
      object.presence = Presence::remembered;
  }
  return belief;
}

std::vector<SceneDecisions> MemoryData::decisions(int64_t scene, size_t count) const {
  const std::lock_guard lock(mutex_);
  std::vector<SceneDecisions> decided;
  mark_scene(scene, 0, [&](size_t number) {
    for (size_t i = number + 1 - std::min(count, number + 1); i <= number; ++i)
      decided.push_back(read_decisions(store_, index_, index_.scenes[i]));
  });
  return decided;
}

std::vector<ImageBox> MemoryData::boxes(const memory::SceneRow& row, const SceneContent& content) const {
  std::unordered_map<memory::Id, memory::Id> object_of;
  for (const memory::AssociationRow& association : store_.associations(row.id))
    if (association.chosen && association.observation && association.object && association.probability > 0)
      object_of[*association.observation] = *association.object;
  std::vector<ImageBox> boxes;
  for (const memory::ObservationRow& seen : store_.observations(row.id)) {
    if (!seen.roi) continue;
    const auto found = object_of.find(seen.id);
    ImageBox box;
    box.object = found == object_of.end() ? 0 : found->second;
    box.number = seen.number;
    if (box.object != 0) box.name = index_.name_of(box.object);
    const auto& roi = *seen.roi;
    box.depth = cv::Rect2d(roi[0], roi[1], roi[2], roi[3]);
    box.color = in_color_image(box.depth, seen.position, content);
    if (seen.mask) add_outlines(read_mask(store_, *seen.mask), seen.position, content, box);
    boxes.push_back(std::move(box));
  }
  return boxes;
}

/// The cameras of a scene: the depth camera is in its row, the colour camera beside it when a pipeline of
/// ours wrote it; otherwise the image is taken to be registered to the depth.
mapping::RgbdCamera MemoryData::cameras_of(const memory::SceneRow& row) const {
  mapping::RgbdCamera cameras;
  cameras.depth = cameras.color = pinhole_of(*row.camera);
  for (const memory::FeatureStructureRow& stored :
       store_.feature_structures(row.id, std::string(perception::types::CameraInfo::kTypeName))) {
    perception::cas::Cas cas(perception::types::type_system());
    const perception::types::CameraInfo info(read_feature_structure(store_, stored.id, cas));
    if (info.name.get() != "color") continue;
    cameras.color = {info.width.get(), info.height.get(), info.fx.get(),
                     info.fy.get(),    info.cx.get(),     info.cy.get()};
    if (const perception::types::Transform pose = info.depth_from_camera.get())
      cameras.depth_from_color = perception::types::from<Isometry3d>(pose);
  }
  return cameras;
}

SceneContent MemoryData::scene(int64_t id) const {
  const std::lock_guard lock(mutex_);
  const memory::SceneRow row = store_.scene(id);
  SceneContent content;
  mark_scene(id, 0, [&](size_t number) { content.scene = index_.scenes[number]; });
  content.map_from_camera = row.map_from_camera;
  if (row.camera) content.camera = cameras_of(row);
  if (row.image) content.color = read_image(store_, *row.image);
  if (row.depth && row.depth_width > 0) {
    std::vector<float> depth = memory::decode_depth_thumbnail(store_.blob(*row.depth).bytes);
    if (depth.size() == static_cast<size_t>(row.depth_width) * static_cast<size_t>(row.depth_height))
      content.depth = cv::Mat(row.depth_height, row.depth_width, CV_32F, depth.data()).clone();
  }
  if (const auto kinds = pixel_kinds(store_, row)) {
    content.kinds = cv::Mat(kinds->height, kinds->width, CV_8U);
    for (size_t i = 0; i < kinds->pixels.size(); ++i)
      content.kinds.data[i] = static_cast<uint8_t>(kinds->pixels[i]);
  }
  content.boxes = boxes(row, content);
  return content;
}

std::vector<HistoryEntry> MemoryData::history(int64_t object) const {
  const std::lock_guard lock(mutex_);
  std::vector<HistoryEntry> entries;
  for (const memory::ObjectHistory& history :
       ask(store_, memory::HistoryQuestion{memory::object_name(object), {}}).objects)
    for (const memory::Change& change : history.changes) {
      const auto& place = change.place ? change.place : change.from_place;
      std::string what = memory::to_text(change.kind);
      std::replace(what.begin(), what.end(), '_', ' ');
      entries.push_back({change.time, place ? place->name : "", what, change.probability});
    }
  return entries;
}

std::vector<TimeNs> MemoryData::observations(int64_t object) const {
  const std::lock_guard lock(mutex_);
  std::vector<TimeNs> times;
  for (const memory::ObjectObservation& sighting : store_.observations_of(object))
    times.push_back(sighting.time);
  return times;
}

std::vector<TracePoint> MemoryData::trace(int64_t object) const {
  constexpr double kStays = 0.03;  // metres: what is measured of a thing at rest differs by as much
  const std::lock_guard lock(mutex_);
  std::vector<TracePoint> trace;
  for (const memory::ObjectObservation& sighting : store_.observations_of(object)) {
    const auto& position = sighting.observation.position;
    if (position && (trace.empty() || (*position - trace.back().position).norm() > kStays))
      trace.push_back({sighting.time, *position});
  }
  return trace;
}

ColoredCloud MemoryData::object_cloud(int64_t object, TimeNs time, std::optional<TimeNs> known_at) const {
  const std::lock_guard lock(mutex_);
  const auto last = store_.last_observation_before(object, time + 1, {}, {time, known_at});
  if (!last) return {};
  const memory::SceneRow row = store_.scene(last->observation.scene);
  if (!row.camera || !row.map_from_camera) return {};
  SceneContent content;  // as far as colours need it
  content.camera = cameras_of(row);
  if (row.image) content.color = read_image(store_, *row.image);
  ColoredCloud cloud;
  for (const Eigen::Vector3f& point : measured_points(store_, row, last->observation).points) {
    const Vector3d in_camera = point.cast<double>();
    cloud.points.push_back((*row.map_from_camera * in_camera).cast<float>());
    cloud.colors.push_back(color_at(content, in_camera));
  }
  return cloud;
}

std::vector<Look> MemoryData::looks_for_object(int64_t object, size_t first_scene) const {
  const std::lock_guard lock(mutex_);
  std::vector<Look> looks(index_.scenes.size() - std::min(first_scene, index_.scenes.size()), Look::nothing);
  if (looks.empty()) return looks;
  for (const memory::VisibilityRow& row :
       store_.visibility_of_object(object, index_.scenes[first_scene].time))
    if (row.status == memory::ObjectStatus::missed)
      mark_scene(row.scene, first_scene, [&](size_t number) { looks[number] = Look::missed; });
  for (const memory::ObjectObservation& sighting :
       store_.observations_of(object, {}, index_.scenes[first_scene].time))
    mark_scene(sighting.observation.scene, first_scene, [&](size_t number) { looks[number] = Look::seen; });
  return looks;
}

std::vector<Look> MemoryData::looks_at_place(const std::string& place, size_t first_scene) const {
  const std::lock_guard lock(mutex_);
  std::vector<Look> looks(index_.scenes.size() - std::min(first_scene, index_.scenes.size()), Look::nothing);
  for (const auto& [id, name] : index_.places)
    if (name == place && !looks.empty())
      for (const memory::VisibilityRow& row : store_.visibility_of_place(id, index_.scenes[first_scene].time))
        if (row.fraction.value_or(0) > 0)
          mark_scene(row.scene, first_scene, [&](size_t number) { looks[number] = Look::seen; });
  return looks;
}

cv::Mat MemoryData::image(int64_t object, TimeNs time) const {
  const std::lock_guard lock(mutex_);
  std::optional<memory::Id> crop;
  const auto last = store_.last_observation_before(object, time + 1, {});
  if (last) crop = last->observation.crop;
  if (last && !crop)
    for (const memory::ObjectObservation& sighting : store_.observations_of(object, {time, std::nullopt}))
      if (sighting.observation.crop) crop = sighting.observation.crop;
  return crop ? read_image(store_, *crop) : cv::Mat();
}

TimeNs MemoryData::time_of(const std::string& text) const {
  const std::lock_guard lock(mutex_);
  const memory::TimeSpan span = memory::TimeReader(store_).read(text);
  // Nothing changes between scenes: the belief at the last scene is that at the end of the span.
  TimeNs time = span.first;
  for (const SceneEntry& scene : index_.scenes)
    if (scene.time >= span.first && scene.time <= span.last) time = scene.time;
  return time;
}

FoundThings MemoryData::find(const std::string& words, TimeNs time) const {
  const std::lock_guard lock(mutex_);
  const memory::Snapshot snapshot(store_, {time, std::nullopt});
  if (world() != nullptr && world()->find_link(words) != nullptr) return {{}, words};
  for (const auto& [id, name] : index_.places)
    if (name == words) return {{}, words};
  try {
    return {snapshot.find_objects(words), {}};
  } catch (const Error&) {  // No object: perhaps the alias or the beginning of a place's name.
  }
  try {
    return {{}, snapshot.find_places(words).front().name};
  } catch (const Error&) {
  }
  std::vector<std::string> names;
  for (const memory::BeliefRow& row : snapshot.beliefs()) names.push_back(index_.name_of(row.object));
  for (const auto& [id, name] : index_.places) names.push_back(name);
  throw Error(fmt::format("no object or place is known as '{}' at this time", words), {path_.string(), 0, {}},
              did_you_mean(words, names));
}

}  // namespace

std::unique_ptr<BrowserData> open_memory_data(const std::filesystem::path& path, Progress& progress) {
  return std::make_unique<MemoryData>(path, nullptr, progress);
}

std::unique_ptr<BrowserData> open_memory_data(const std::filesystem::path& path) {
  NoProgress progress;
  return open_memory_data(path, progress);
}

}  // namespace loci::gui
