#include "gui/data/open_memory.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "gui/data/decisions.h"
#include "gui/data/object_details.h"
#include "mapping/image/hsv.h"
#include "memory/exchange/observation_image.h"
#include "memory/questions/location.h"
#include "memory/questions/snapshot.h"
#include "memory/questions/time_parser.h"
#include "memory/sentences/natural_language.h"
#include "memory/sentences/suggestions.h"
#include "memory/store/scene_images.h"

namespace loci::gui {
namespace {

constexpr double kSamePlace = 0.03;  // metres: the noise of an object at rest

}  // namespace

std::array<uint8_t, 3> rgb_of(const memory::BeliefRow& belief) {
  if (!belief.hsv) return mapping::kUnknownRgb;
  return mapping::rgb8_from_hsv(belief.hsv->hue, belief.hsv->saturation, belief.hsv->value);
}

const BelievedObject* Belief::find(memory::Id object) const {
  const auto found = std::find_if(objects.begin(), objects.end(),
                                  [&](const BelievedObject& other) { return other.object == object; });
  return found == objects.end() ? nullptr : &*found;
}

std::shared_ptr<const OpenMemory> OpenMemory::open(const std::filesystem::path& path, Progress& progress) {
  return std::make_shared<const OpenMemory>(path, nullptr, progress);
}

std::shared_ptr<const OpenMemory> OpenMemory::open(const std::filesystem::path& path) {
  NoProgress progress;
  return open(path, progress);
}

std::shared_ptr<const OpenMemory> OpenMemory::renewed(Progress& progress) const {
  return std::make_shared<const OpenMemory>(path_, &index_, progress);
}

OpenMemory::OpenMemory(const std::filesystem::path& path, const MemoryIndex* before, Progress& progress)
    : path_(path), store_(memory::Store::open_read(path)), index_(read_index(store_, before, progress)) {}

std::shared_ptr<const mapping::World> OpenMemory::shared_world(std::optional<TimeNs> time) const {
  if (index_.worlds.empty()) return nullptr;
  const auto after = time ? index_.worlds.upper_bound(*time) : index_.worlds.end();
  return after == index_.worlds.begin() ? after->second : std::prev(after)->second;
}

const mapping::World* OpenMemory::world(std::optional<TimeNs> time) const {
  return shared_world(time).get();
}

const memory::SceneRow* OpenMemory::scene_at(TimeNs time) const {
  const auto& all = scenes();
  if (all.empty()) return nullptr;
  const auto after = std::upper_bound(all.begin(), all.end(), time,
                                      [](TimeNs t, const memory::SceneRow& scene) { return t < scene.time; });
  return after == all.begin() ? &all.front() : &*(after - 1);
}

const memory::ObservationRow& OpenMemory::observation(memory::Id id) const {
  const auto found = observations_.find(id);
  return found != observations_.end() ? found->second
                                      : observations_.emplace(id, store_.observation(id)).first->second;
}

BelievedObject OpenMemory::believed(const memory::BeliefRow& row) const {
  BelievedObject object{row, {}, {}, {}};
  if (const auto box =
          memory::believed_box(row, row.last_observation ? &observation(*row.last_observation) : nullptr)) {
    object.map_from_object = box->map_from_box;
    object.box_size = box->size;
  }
  if (const memory::SceneRow* scene = index_.scene(row.last_scene)) object.last_seen = scene->time;
  return object;
}

Belief OpenMemory::belief_at(TimeNs time, std::optional<TimeNs> known_at) const {
  const std::lock_guard lock(mutex_);
  Belief belief{.time = time, .world = shared_world(time), .names = index_.names};
  const memory::SceneRow* scene = scene_at(time);
  if (scene != nullptr && scene->time <= time)
    for (const auto& [joint, position] : scene->joints) belief.joints[names().parts.joint(joint)] = position;
  for (const memory::BeliefRow& row : store_.beliefs({time, known_at}))
    belief.objects.push_back(believed(row));
  return belief;
}

std::vector<SceneDecisions> OpenMemory::decisions(memory::Id scene, size_t count) const {
  const std::lock_guard lock(mutex_);
  std::vector<SceneDecisions> decided;
  mark_scene(scene, 0, [&](size_t number) {
    for (size_t i = number + 1 - std::min(count, number + 1); i <= number; ++i)
      decided.push_back(read_decisions(store_, names(), index_.scenes[i]));
  });
  return decided;
}

ObjectDetails OpenMemory::details(memory::Id object, TimeNs time) const {
  const std::lock_guard lock(mutex_);
  return read_details(store_, index_, object, time);
}

SceneContent OpenMemory::scene(memory::Id id) const {
  const std::lock_guard lock(mutex_);
  return read_scene_content(store_, store_.scene(id));
}

std::vector<ImageNote> OpenMemory::notes(memory::Id scene) const {
  const std::lock_guard lock(mutex_);
  return image_notes(store_, scene);
}

std::vector<memory::Change> OpenMemory::history(memory::Id object) const {
  const std::lock_guard lock(mutex_);
  std::vector<memory::Change> changes;
  for (memory::ObjectHistory& history :
       ask(store_, memory::HistoryQuestion{memory::object_name(object), {}}).objects)
    std::move(history.changes.begin(), history.changes.end(), std::back_inserter(changes));
  return changes;
}

PlaceDetails OpenMemory::place_details(const std::string& place, TimeNs time) const {
  const std::lock_guard lock(mutex_);
  PlaceDetails details;
  for (const memory::PlaceRow& row : memory::named_places(store_)) {
    if (row.name != place) continue;
    details.height = row.height;
    const auto last = store_.last_visibility(row.id, {.at = time});
    if (!last) continue;
    details.seen = last->fraction.value_or(0);
    if (const memory::SceneRow* scene = index_.scene(last->scene)) details.last_look = scene->time;
  }
  return details;
}

std::vector<TimeNs> OpenMemory::observations(memory::Id object) const {
  const std::lock_guard lock(mutex_);
  std::vector<TimeNs> times;
  for (const memory::ObjectObservation& seen : store_.observations_of(object)) times.push_back(seen.time);
  return times;
}

std::vector<TrajectoryPoint> OpenMemory::trajectory(memory::Id object) const {
  const std::lock_guard lock(mutex_);
  std::vector<TrajectoryPoint> points;
  for (const memory::ObjectObservation& seen : store_.observations_of(object)) {
    const auto& position = seen.observation.position;
    if (position && (points.empty() || (*position - points.back().position).norm() > kSamePlace))
      points.push_back({seen.time, *position});
  }
  return points;
}

ColoredCloud OpenMemory::object_cloud(memory::Id object, TimeNs time, std::optional<TimeNs> known_at) const {
  const std::lock_guard lock(mutex_);
  const auto last = store_.last_observation_before(object, time + 1, {}, {time, known_at});
  if (!last) return {};
  const memory::SceneRow row = store_.scene(last->observation.scene);
  if (!row.camera || !row.map_from_camera) return {};
  SceneContent content;  // as far as colours need it
  content.camera = cameras_of(store_, row);
  if (row.image) content.color = read_image(store_, *row.image);
  ColoredCloud cloud;
  for (const Eigen::Vector3f& point : measured_points(store_, row, last->observation).points) {
    const Vector3d in_camera = point.cast<double>();
    cloud.points.push_back((*row.map_from_camera * in_camera).cast<float>());
    cloud.colors.push_back(color_at(content, in_camera));
  }
  return cloud;
}

std::vector<memory::ObjectStatus> OpenMemory::visibility_of_object(memory::Id object,
                                                                   size_t first_scene) const {
  const std::lock_guard lock(mutex_);
  std::vector<memory::ObjectStatus> shown(index_.scenes.size() - std::min(first_scene, index_.scenes.size()),
                                          memory::ObjectStatus::out_of_view);
  if (shown.empty()) return shown;
  const TimeNs from = index_.scenes[first_scene].time;
  for (const memory::VisibilityRow& row : store_.visibility_of_object(object, from))
    if (row.status == memory::ObjectStatus::missed)
      mark_scene(row.scene, first_scene,
                 [&](size_t number) { shown[number] = memory::ObjectStatus::missed; });
  for (const memory::ObjectObservation& seen : store_.observations_of(object, {}, from))
    mark_scene(seen.observation.scene, first_scene,
               [&](size_t number) { shown[number] = memory::ObjectStatus::seen; });
  return shown;
}

std::vector<memory::ObjectStatus> OpenMemory::visibility_of_place(const std::string& place,
                                                                  size_t first_scene) const {
  const std::lock_guard lock(mutex_);
  std::vector<memory::ObjectStatus> shown(index_.scenes.size() - std::min(first_scene, index_.scenes.size()),
                                          memory::ObjectStatus::out_of_view);
  for (const auto& [id, name] : names().places)
    if (name == place && !shown.empty())
      for (const memory::VisibilityRow& row : store_.visibility_of_place(id, index_.scenes[first_scene].time))
        if (row.fraction.value_or(0) > 0)
          mark_scene(row.scene, first_scene,
                     [&](size_t number) { shown[number] = memory::ObjectStatus::seen; });
  return shown;
}

cv::Mat OpenMemory::image(memory::Id object, TimeNs time) const {
  const std::lock_guard lock(mutex_);
  std::optional<memory::Id> crop;
  const auto last = store_.last_observation_before(object, time + 1, {});
  if (last) crop = last->observation.crop;
  if (last && !crop)
    for (const memory::ObjectObservation& seen : store_.observations_of(object, {time, std::nullopt}))
      if (seen.observation.crop) crop = seen.observation.crop;
  return crop ? read_image(store_, *crop) : cv::Mat();
}

double OpenMemory::certainty_of_last_sighting(memory::Id object, TimeNs time,
                                              std::optional<TimeNs> known_at) const {
  const std::lock_guard lock(mutex_);
  const auto last = store_.last_observation_before(object, time + 1, {}, {{}, known_at});
  return last ? last->association.probability : 1;
}

TimeNs OpenMemory::time_of(const std::string& text) const {
  const std::lock_guard lock(mutex_);
  const memory::TimeSpan span = memory::TimeReader(store_).read(text);
  // Nothing changes between scenes: the belief at the last scene is that at the end of the span.
  TimeNs time = span.first;
  for (const memory::SceneRow& scene : index_.scenes)
    if (scene.time >= span.first && scene.time <= span.last) time = scene.time;
  return time;
}

SearchResult OpenMemory::find(const std::string& text, TimeNs time) const {
  const std::lock_guard lock(mutex_);
  const memory::Snapshot snapshot(store_, {time, std::nullopt});
  if (world() != nullptr && world()->find_link(text) != nullptr) return {{}, text};
  for (const auto& [id, name] : names().places)
    if (name == text) return {{}, text};
  try {
    return {snapshot.find_objects(text), {}};
  } catch (const Error&) {  // No object: perhaps the alias or the beginning of a place's name.
  }
  try {
    return {{}, snapshot.find_places(text).front().name};
  } catch (const Error&) {
  }
  std::vector<std::string> known;
  for (const memory::BeliefRow& row : snapshot.beliefs()) known.push_back(names().object(row.object));
  for (const auto& [id, name] : names().places) known.push_back(name);
  throw Error(fmt::format("no object or place is known as '{}' at this time", text), {path_.string(), 0, {}},
              did_you_mean(text, known));
}

// A question may take long and reads through a Store of its own.
TypedAnswer OpenMemory::answer(const TypedQuestion& question) const {
  return answer_question(memory::Store::open_read(path_), question);
}

std::vector<std::string> OpenMemory::example_questions() const {
  return memory::suggested_questions(memory::Store::open_read(path_));
}

std::vector<std::string> OpenMemory::known_words() const {
  return memory::known_names(memory::Store::open_read(path_));
}

}  // namespace loci::gui
