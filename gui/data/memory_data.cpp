#include "gui/data/memory_data.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <opencv2/imgproc.hpp>

#include "mapping/image/image_io.h"
#include "mapping/world/urdf.h"
#include "memory/questions/people_time.h"
#include "memory/questions/snapshot.h"
#include "memory/questions/words.h"
#include "memory/store/depth_thumbnail.h"
#include "memory/store/feature_structures.h"
#include "memory/store/store.h"
#include "perception/types/geometry.h"
#include "perception/types/types.h"

namespace loci {
namespace {

Presence presence_of(const std::string& status) {
  if (status == "seen") return Presence::seen;
  if (status == "missed") return Presence::missed;
  if (status == "hidden") return Presence::hidden;
  if (status == "gone") return Presence::gone;
  return Presence::remembered;
}

std::array<uint8_t, 3> rgb_of(const HsvColor& hsv) {
  const double chroma = hsv.value * hsv.saturation;
  const auto channel = [&](double shift) {
    const double k = std::fmod(shift + hsv.hue / 60, 6);
    const double level = hsv.value - chroma * std::clamp(std::min(k, 4 - k), 0.0, 1.0);
    return static_cast<uint8_t>(std::lround(std::clamp(level, 0.0, 1.0) * 255));
  };
  return {channel(5), channel(3), channel(1)};
}

cv::Mat decode_color(const BlobRow& blob, const std::string& name) {
  const std::vector<unsigned char> bytes(blob.bytes.begin(), blob.bytes.end());
  const cv::Mat image = decode_image(bytes, name);
  if (image.type() == CV_8UC3) return image;
  if (image.depth() != CV_8U) throw Error("a picture with more than 8 bits", {name, 0, {}});
  cv::Mat color;
  cv::cvtColor(image, color, image.channels() == 4 ? cv::COLOR_BGRA2BGR : cv::COLOR_GRAY2BGR);
  return color;
}

PinholeCamera pinhole_of(const SceneCamera& camera) {
  return {camera.width, camera.height, camera.fx, camera.fy, camera.cx, camera.cy};
}

/// Where a part of the depth picture is in the colour picture, at the distance of what it shows.
cv::Rect2d in_color_picture(const cv::Rect2d& roi, const std::optional<Vector3d>& position,
                            const SceneContent& content) {
  const RgbdCamera& camera = content.camera;
  const Isometry3d color_from_depth = camera.depth_from_color.inverse();
  double z = 1;
  if (position && content.map_from_camera) z = (content.map_from_camera->inverse() * *position).z();
  Eigen::AlignedBox2d area;
  for (const auto& [u, v] : {std::pair(roi.x, roi.y), std::pair(roi.x + roi.width, roi.y + roi.height)})
    area.extend(camera.color.project(color_from_depth * camera.depth.unproject(u, v, std::max(z, 0.1))));
  return {area.min().x(), area.min().y(), area.sizes().x(), area.sizes().y()};
}

class MemoryData : public BrowserData {
 public:
  MemoryData(const std::filesystem::path& path, Progress& progress)
      : path_(path), store_(Store::open_read(path)) {
    progress.check(0.1, "reading scenes");
    for (const PlaceRow& place : store_.places()) places_[place.id] = place.name;
    read_names();
    read_scenes();
    progress.check(0.3, "reading events");
    read_events();
    progress.check(0.9, "reading the map");
    read_map();
    describe();
  }

  const MemoryInfo& info() const override { return info_; }
  const std::vector<SceneEntry>& scenes() const override { return scenes_; }
  const std::vector<EventEntry>& events() const override { return events_; }
  const std::optional<World>& world() const override { return world_; }
  MeshSearch mesh_search() const override { return {{}, store_.path().parent_path()}; }

  std::vector<PlaceOutline> loose_places() const override;
  BelievedScene belief_at(TimeNs time) const override;
  SceneContent scene(int64_t id) const override;
  std::vector<HistoryEntry> history(int64_t object) const override;
  std::vector<TimeNs> observations(int64_t object) const override;
  std::vector<Look> looks_for_object(int64_t object) const override;
  std::vector<Look> looks_at_place(const std::string& place) const override;
  cv::Mat picture(int64_t object, TimeNs time) const override;
  // A Store belongs to one thread: what may be asked from another opens its own.
  TypedAnswer answer(const TypedQuestion& question) const override {
    return answer_question(Store::open_read(path_), question);
  }
  std::vector<std::string> example_questions() const override {
    return loci::example_questions(Store::open_read(path_));
  }
  std::vector<std::string> known_words() const override { return loci::known_words(Store::open_read(path_)); }
  TimeNs time_of(const std::string& text) const override;
  FoundThings find(const std::string& words, TimeNs time) const override;

 private:
  void read_names();
  void read_scenes();
  void read_events();
  void read_map();
  void describe();
  std::string place_name(std::optional<Id> id) const;
  std::string name_of(Id object) const;
  BelievedObject believed(const BeliefRow& row) const;
  const ObservationRow& observation(Id id) const;
  RgbdCamera cameras_of(const SceneRow& row) const;
  SceneContent read_scene(const SceneRow& row) const;
  std::vector<ImageBox> boxes(const SceneRow& row, const SceneContent& content) const;

  std::filesystem::path path_;
  Store store_;
  MemoryInfo info_;
  std::map<Id, std::string> places_;
  std::map<Id, std::string> aliases_, classes_, owners_;
  std::vector<SceneEntry> scenes_;
  std::map<Id, SceneRow> rows_;
  std::map<Id, size_t> number_of_scene_;  ///< its index in scenes_
  std::vector<EventEntry> events_;
  std::optional<World> world_;
  mutable std::optional<SceneContent> last_scene_;
  mutable std::map<Id, ObservationRow> observations_;  ///< read once, asked for at every step in time
};

void MemoryData::read_names() {
  for (const FactRow& fact : store_.facts()) {
    if (!fact.object || !fact.value) continue;
    if (fact.key == "alias") aliases_[*fact.object] = *fact.value;
    if (fact.key == "owner") owners_[*fact.object] = *fact.value;
    if (fact.key == "class") classes_[*fact.object] = *fact.value;
  }
}

void MemoryData::read_scenes() {
  for (SceneRow& row : store_.scenes()) {
    const std::string name =
        row.frame_index ? fmt::format("frame {}", *row.frame_index) : fmt::format("scene {}", row.id);
    number_of_scene_[row.id] = scenes_.size();
    scenes_.push_back({row.id, row.time, name, row.map_from_camera});
    rows_.emplace(row.id, std::move(row));
  }
}

void MemoryData::read_events() {
  for (const Change& change : ask(store_, ChangesQuestion{}).changes)
    events_.push_back({change.time, change.kind, change.object ? change.object->id : 0, change_text(change)});
  std::stable_sort(events_.begin(), events_.end(),
                   [](const EventEntry& a, const EventEntry& b) { return a.time < b.time; });
}

void MemoryData::read_map() {
  const auto maps = store_.maps();
  if (maps.empty()) return;
  const MapRow& newest = maps.back();
  world_ = parse_urdf(store_.blob(newest.urdf).bytes, newest.name);
}

std::vector<PlaceOutline> MemoryData::loose_places() const {
  std::vector<PlaceOutline> loose;
  for (const PlaceRow& place : store_.places())
    if (place.height && place.outline.size() > 2 && !(world_ && world_->find_link(place.name) != nullptr))
      loose.push_back({place.name, place.outline, *place.height});
  return loose;
}

void MemoryData::describe() {
  info_.path = store_.path().string();
  info_.schema = fmt::format("{}.{}", store_.major(), store_.minor());
  info_.zone_minutes = store_.time_zone_minutes();
  for (const RecordingRow& recording : store_.recordings()) info_.time_assumed |= recording.time_assumed;
  const auto plural = [](size_t n, const char* what) {
    return fmt::format("{} {}{}", n, what, n == 1 ? "" : "s");
  };
  info_.summary = fmt::format("{} · {} · {}", plural(scenes_.size(), "scene"),
                              plural(store_.objects().size(), "object"), plural(events_.size(), "event"));
  if (!world_) info_.summary += " · no map";
}

std::string MemoryData::place_name(std::optional<Id> id) const {
  const auto found = id ? places_.find(*id) : places_.end();
  return found == places_.end() ? std::string() : found->second;
}

std::string MemoryData::name_of(Id object) const {
  const auto alias = aliases_.find(object);
  return alias == aliases_.end() ? object_name(object) : alias->second;
}

const ObservationRow& MemoryData::observation(Id id) const {
  const auto found = observations_.find(id);
  return found != observations_.end() ? found->second
                                      : observations_.emplace(id, store_.observation(id)).first->second;
}

BelievedObject MemoryData::believed(const BeliefRow& row) const {
  BelievedObject object;
  object.id = row.object;
  object.name = name_of(row.object);
  if (const auto found = classes_.find(row.object); found != classes_.end())
    object.class_name = found->second;
  if (const auto found = owners_.find(row.object); found != owners_.end()) object.owner = found->second;
  object.color_name = row.color.value_or("");
  object.place = place_name(row.place);
  object.presence = presence_of(row.status);
  object.probability = row.probability;
  object.size = row.size.value_or(Vector3d::Zero());
  if (row.hsv) object.rgb = rgb_of(*row.hsv);
  Isometry3d pose = Isometry3d::Identity();
  bool placed = false;
  if (row.last_observation) {  // The belief is a position; how the thing is turned, its last sight says.
    const ObservationRow& seen = observation(*row.last_observation);
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
    if (const auto scene = rows_.find(*row.last_scene); scene != rows_.end())
      object.last_seen = scene->second.time;
  return object;
}

BelievedScene MemoryData::belief_at(TimeNs time) const {
  BelievedScene belief;
  belief.time = time;
  const SceneEntry* entry = scene_at(time);
  if (entry != nullptr && entry->time <= time) belief.joints = rows_.at(entry->id).joints;
  for (const BeliefRow& row : store_.beliefs({time, std::nullopt})) {
    belief.objects.push_back(believed(row));
    // A belief holds until the next one: what an earlier scene saw is remembered now.
    BelievedObject& object = belief.objects.back();
    if (object.presence == Presence::seen && entry != nullptr && object.last_seen != entry->time)
      object.presence = Presence::remembered;
  }
  return belief;
}

std::vector<ImageBox> MemoryData::boxes(const SceneRow& row, const SceneContent& content) const {
  std::map<Id, Id> object_of;
  for (const AssociationRow& association : store_.associations(row.id))
    if (association.chosen && association.observation && association.object && association.probability > 0)
      object_of[*association.observation] = *association.object;
  std::vector<ImageBox> boxes;
  for (const ObservationRow& seen : store_.observations(row.id)) {
    if (!seen.roi) continue;
    const auto found = object_of.find(seen.id);
    ImageBox box;
    box.object = found == object_of.end() ? 0 : found->second;
    if (box.object != 0) box.name = name_of(box.object);
    const auto& roi = *seen.roi;
    box.depth = cv::Rect2d(roi[0], roi[1], roi[2], roi[3]);
    box.color = in_color_picture(box.depth, seen.position, content);
    boxes.push_back(std::move(box));
  }
  return boxes;
}

/// The cameras of a scene: the depth camera is in its row, the colour camera beside it when a pipeline of
/// ours wrote it; otherwise the picture is taken to be registered to the depth.
RgbdCamera MemoryData::cameras_of(const SceneRow& row) const {
  RgbdCamera cameras;
  cameras.depth = cameras.color = pinhole_of(*row.camera);
  for (const FeatureStructureRow& stored :
       store_.feature_structures(row.id, std::string(types::CameraInfo::kTypeName))) {
    cas::Cas cas(types::type_system());
    const types::CameraInfo info(read_feature_structure(store_, stored.id, cas));
    if (info.name.get() != "color") continue;
    cameras.color = {info.width.get(), info.height.get(), info.fx.get(),
                     info.fy.get(),    info.cx.get(),     info.cy.get()};
    if (const types::Transform pose = info.depth_from_camera.get())
      cameras.depth_from_color = types::from<Isometry3d>(pose);
  }
  return cameras;
}

SceneContent MemoryData::scene(int64_t id) const {
  const auto found = rows_.find(id);
  if (found == rows_.end()) throw Error(fmt::format("no scene {}", id), {info_.path, 0, {}});
  // Map and picture ask for the same scene one after the other.
  if (!last_scene_ || last_scene_->scene.id != id) last_scene_ = read_scene(found->second);
  return *last_scene_;
}

SceneContent MemoryData::read_scene(const SceneRow& row) const {
  SceneContent content;
  content.scene =
      *std::find_if(scenes_.begin(), scenes_.end(), [&](const SceneEntry& s) { return s.id == row.id; });
  content.map_from_camera = row.map_from_camera;
  if (row.camera) content.camera = cameras_of(row);
  if (row.picture)
    content.color =
        decode_color(store_.blob(*row.picture), fmt::format("{}: picture of scene {}", info_.path, row.id));
  if (row.depth && row.depth_width > 0) {
    std::vector<float> depth = decode_depth_thumbnail(store_.blob(*row.depth).bytes);
    if (depth.size() == static_cast<size_t>(row.depth_width) * static_cast<size_t>(row.depth_height))
      content.depth = cv::Mat(row.depth_height, row.depth_width, CV_32F, depth.data()).clone();
  }
  content.boxes = boxes(row, content);
  return content;
}

std::vector<HistoryEntry> MemoryData::history(int64_t object) const {
  std::vector<HistoryEntry> entries;
  for (const ObjectHistory& history : ask(store_, HistoryQuestion{object_name(object), {}}).objects)
    for (const Change& change : history.changes) {
      const auto& place = change.place ? change.place : change.from_place;
      std::string what = change.kind;
      std::replace(what.begin(), what.end(), '_', ' ');
      entries.push_back({change.time, place ? place->name : "", what, change.probability});
    }
  return entries;
}

std::vector<TimeNs> MemoryData::observations(int64_t object) const {
  std::vector<TimeNs> times;
  for (const Sighting& sighting : store_.sightings(object)) times.push_back(sighting.time);
  return times;
}

std::vector<Look> MemoryData::looks_for_object(int64_t object) const {
  std::vector<Look> looks(scenes_.size(), Look::nothing);
  for (const VisibilityRow& row : store_.visibility_of_object(object))
    if (const auto scene = number_of_scene_.find(row.scene); scene != number_of_scene_.end())
      if (row.status == "missed") looks[scene->second] = Look::missed;
  for (const Sighting& sighting : store_.sightings(object))
    if (const auto scene = number_of_scene_.find(sighting.observation.scene); scene != number_of_scene_.end())
      looks[scene->second] = Look::seen;
  return looks;
}

std::vector<Look> MemoryData::looks_at_place(const std::string& place) const {
  std::vector<Look> looks(scenes_.size(), Look::nothing);
  for (const auto& [id, name] : places_)
    if (name == place)
      for (const VisibilityRow& row : store_.visibility_of_place(id))
        if (const auto scene = number_of_scene_.find(row.scene); scene != number_of_scene_.end())
          if (row.fraction.value_or(0) > 0) looks[scene->second] = Look::seen;
  return looks;
}

cv::Mat MemoryData::picture(int64_t object, TimeNs time) const {
  std::optional<Id> crop;
  for (const Sighting& sighting : store_.sightings(object, {time, std::nullopt}))
    if (sighting.observation.crop) crop = sighting.observation.crop;
  return crop ? decode_color(store_.blob(*crop), fmt::format("{}: picture of object {}", info_.path, object))
              : cv::Mat();
}

TimeNs MemoryData::time_of(const std::string& text) const {
  const TimeSpan span = TimeReader(store_).read(text);
  // Nothing changes between scenes: the belief at the last scene is that at the end of the span.
  TimeNs time = span.first;
  for (const SceneEntry& scene : scenes_)
    if (scene.time >= span.first && scene.time <= span.last) time = scene.time;
  return time;
}

FoundThings MemoryData::find(const std::string& words, TimeNs time) const {
  const Snapshot snapshot(store_, {time, std::nullopt});
  if (world_ && world_->find_link(words) != nullptr) return {{}, words};
  for (const auto& [id, name] : places_)
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
  for (const BeliefRow& row : snapshot.beliefs()) names.push_back(name_of(row.object));
  for (const auto& [id, name] : places_) names.push_back(name);
  throw Error(fmt::format("no object or place is known as '{}' at this time", words), {info_.path, 0, {}},
              did_you_mean(words, names));
}

}  // namespace

std::unique_ptr<BrowserData> open_memory_data(const std::filesystem::path& path, Progress& progress) {
  return std::make_unique<MemoryData>(path, progress);
}

std::unique_ptr<BrowserData> open_memory_data(const std::filesystem::path& path) {
  NoProgress progress;
  return open_memory_data(path, progress);
}

}  // namespace loci
