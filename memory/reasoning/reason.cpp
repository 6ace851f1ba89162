#include "memory/reasoning/reason.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "mapping/base/text/json.h"
#include "mapping/base/text/text.h"
#include "memory/reasoning/stored_scene.h"
#include "memory/recorder/recorder.h"
#include "memory/store/memory_file.h"
#include "memory/store/run_configuration.h"
#include "memory/store/scene_images.h"

namespace loci::memory {
namespace {

BlobRecord blob_of(const Store& store, const std::optional<Id>& id) {
  if (!id) return {};
  BlobRow row = store.blob(*id);
  return {std::move(row.bytes), std::move(row.media)};
}

/// Numbers of the first memory in terms of the second.
struct Numbers {
  std::map<Id, Id> recordings, maps;
};

Numbers copy_sources(const Store& from, Store& to) {
  Numbers numbers;
  for (const RecordingRow& row : from.recordings()) numbers.recordings[row.id] = to.add_recording(row);
  for (const MapRow& row : from.maps())
    numbers.maps[row.id] = to.add_map(row.name, from.blob(row.urdf).bytes,
                                      row.sidecar ? from.blob(*row.sidecar).bytes : std::string());
  return numbers;
}

std::optional<Id> translated(const std::map<Id, Id>& numbers, const std::optional<Id>& id) {
  return id && numbers.contains(*id) ? std::optional(numbers.at(*id)) : std::nullopt;
}

/// What is said of places and holds; `places` as in the first memory, but with maps of the second.
void copy_place_facts(const Store& from, const std::vector<PlaceRow>& places, Store& to, Id run) {
  std::map<Id, Id> place_of;
  for (const PlaceRow& place : places) place_of[place.id] = to.add_place(place, run);
  for (FactRow fact : from.facts()) {
    if (!fact.place) continue;
    fact.place = place_of.at(*fact.place);
    fact.clock.supersedes.reset();
    to.add_fact(fact, run);
  }
}

/// A scene of a forgotten period stays, empty.
void copy_forgotten(SceneRow scene, const Numbers& numbers, Store& to, Id run) {
  scene.recording = translated(numbers.recordings, scene.recording);
  scene.map = translated(numbers.maps, scene.map);
  scene.map_from_camera.reset();
  scene.joints.clear();
  for (std::optional<Id>* image : {&scene.depth, &scene.pixel_kinds, &scene.image}) image->reset();
  scene.depth_width = scene.depth_height = 0;
  SceneTransaction row(to, run);
  row.add_scene(scene);
  row.commit();
}

/// The belief after a forgotten scene is the one before it.
void keep_belief_after(Store& to, Id run, const Recorder& recorder, const belief::BeliefOptions& options) {
  SceneTransaction checkpoint(to, run);
  BeliefCheckpoint(options).save(checkpoint, to.last_scene()->id, recorder.belief());
  checkpoint.commit();
}

SceneRecord record_of(const Store& from, const SceneRow& row, const SceneReasoning& reasoning,
                      const std::vector<PlaceRow>& places, const Numbers& numbers) {
  SceneRecord record = stored_scene(from, row, reasoning, places);
  record.source = "reason";
  record.row.recording = translated(numbers.recordings, row.recording);
  record.row.map = translated(numbers.maps, row.map);
  record.row.depth.reset();
  record.row.image.reset();
  record.row.pixel_kinds.reset();
  if (const std::optional<PixelKindImage> kinds = pixel_kinds(from, row))
    record.kinds = cv::Mat(kinds->height, kinds->width, CV_8U,
                           const_cast<mapping::PixelKind*>(kinds->pixels.data()))
                       .clone();  // only read
  record.log = from.log(row.id);
  record.image = blob_of(from, row.image);
  if (row.camera) record.cameras = cameras_of(from, row);
  std::map<Id, size_t> number_of;
  for (ObservationRecord& copy : record.observations) {
    const size_t number = number_of.size();
    number_of[copy.row.id] = number;
    copy.crop = blob_of(from, copy.row.crop);
    copy.mask = blob_of(from, copy.row.mask);
    copy.cloud = blob_of(from, copy.row.cloud);
    copy.row.place.reset();
    copy.row.crop.reset();
    copy.row.mask.reset();
    copy.row.cloud.reset();
  }
  for (const AnnotationRow& annotation : from.annotations(row.id)) {
    auto& list = annotation.observation
                     ? record.observations[number_of.at(*annotation.observation)].annotations
                     : record.annotations;
    list.push_back({annotation.type, annotation.value, annotation.confidence, {}});
  }
  return record;
}

/// Which observation and object of the first memory is which of the second.
class Translation {
 public:
  explicit Translation(const KnownIdentities& known) : known_(known) {}

  /// What is known of the observations of a scene, in numbers of the second memory.
  void identify(SceneRecord& record) const {
    for (ObservationRecord& one : record.observations) {
      const auto known = known_.find(one.row.id);
      if (known == known_.end()) continue;
      const auto number = stated_.find(known->second);
      one.evidence.known_object = number == stated_.end() ? -1 : number->second;
    }
  }

  void add(const Store& from, Id scene, const std::vector<ObservationRecord>& observations,
           const RecordedScene& recorded) {
    std::map<Id, Id> object_of;
    for (const AssociationRow& row : from.associations(scene))
      if (row.chosen && row.observation && row.object && row.probability > 0)
        object_of[*row.observation] = *row.object;
    for (size_t k = 0; k < observations.size(); ++k) {
      const Id before = observations[k].row.id, object = recorded.update.observations[k].object;
      if (const auto known = known_.find(before); known != known_.end()) {
        stated_[known->second] = object;
        groups_[object].push_back(recorded.observations[k]);
      }
      if (const auto was = object_of.find(before); was != object_of.end() && object != 0)
        ++common_[was->second][object];
    }
  }

  /// The object with most observations of one of the first memory.
  std::optional<Id> object(Id before) const {
    const auto counts = common_.find(before);
    if (counts == common_.end()) return std::nullopt;
    return std::ranges::max_element(counts->second, {}, [](const auto& one) { return one.second; })->first;
  }
  const std::map<Id, std::vector<Id>>& groups() const { return groups_; }

 private:
  const KnownIdentities& known_;
  std::map<Id, Id> stated_;               ///< by the number of the first memory
  std::map<Id, std::vector<Id>> groups_;  ///< observations of the second memory
  std::map<Id, std::map<Id, size_t>> common_;
};

/// What people state of objects.
void copy_object_facts(const Store& from, const Translation& translation, Store& to, Id run,
                       ReasonResult& result) {
  for (FactRow fact : from.facts()) {
    if (!fact.object) continue;
    if (const std::optional<Id> object = translation.object(*fact.object)) {
      fact.object = object;
      fact.clock.supersedes.reset();
      to.add_fact(fact, run);
      ++result.facts;
    } else {
      result.unplaced.push_back(fmt::format("{}: {} {}", object_name(*fact.object), fact.key, *fact.value));
    }
  }
}

/// reason() into a file that nobody else knows yet.
void reason_into(const Store& from, const std::vector<SceneRow>& scenes, const std::filesystem::path& other,
                 const belief::BeliefOptions& options, const WriteOptions& write, Progress& progress,
                 const KnownIdentities& known, ReasonResult& result) {
  WriteOptions same_zone = write;
  same_zone.time_zone = from.meta("time_zone").value_or("UTC");
  Store to = Store::open_write(other, same_zone);
  const Numbers numbers = copy_sources(from, to);
  const Id run = to.begin_run(kReasonProgram, Json{{"from", from.path().filename().string()}}.dump());
  std::vector<PlaceRow> places = from.places();
  for (PlaceRow& place : places) place.map = translated(numbers.maps, place.map);
  copy_place_facts(from, places, to, run);
  to.add_tombstones(from, run);
  const std::vector<ForgottenRow> forgotten = from.forgotten();
  Recorder recorder(to, run, options);
  Translation translation(known);
  for (const SceneRow& scene : scenes) {
    progress.check(double(result.scenes + result.skipped) / double(scenes.size()), "reasoning anew");
    if (was_forgotten(forgotten, scene.time)) {
      copy_forgotten(scene, numbers, to, run);
      continue;
    }
    const std::optional<SceneReasoning> reasoning = load_reasoning(from, scene.id);
    if (!reasoning) {
      ++result.skipped;
      continue;
    }
    if (!result.from) result.from = scene.time;
    SceneRecord record = record_of(from, scene, *reasoning, places, numbers);
    translation.identify(record);
    const RecordedScene recorded = recorder.record(record);
    translation.add(from, scene.id, record.observations, recorded);
    ++result.scenes;
    result.observations += recorded.observations.size();
  }
  if (!scenes.empty() && was_forgotten(forgotten, scenes.back().time))
    keep_belief_after(to, run, recorder, options);
  copy_object_facts(from, translation, to, run, result);
  to.finish_run(run);
  if (!known.empty()) to.finish_run(to.begin_run(kReasonProgram, identity_json(translation.groups()).dump()));
}

std::map<std::pair<TimeNs, std::optional<int64_t>>, SceneRow> by_moment(const Store& store) {
  std::map<std::pair<TimeNs, std::optional<int64_t>>, SceneRow> scenes;
  for (const SceneRow& scene : store.scenes()) scenes[{scene.time, scene.frame_index}] = scene;
  return scenes;
}

/// Object of each observation of a scene by its number; 0 = a false cluster.
std::map<int64_t, Id> objects_in(const Store& store, Id scene) {
  std::map<int64_t, Id> object_of;
  std::map<Id, int64_t> number_of;
  for (const ObservationRow& row : store.observations(scene)) {
    number_of[row.id] = row.number;
    object_of[row.number] = 0;
  }
  for (const AssociationRow& row : store.associations(scene))
    if (row.chosen && row.observation && row.object) object_of[number_of.at(*row.observation)] = *row.object;
  return object_of;
}

/// Which object of the second memory is which of the first: most common observations first, each once.
std::map<Id, Id> paired(const std::map<std::pair<Id, Id>, size_t>& common) {
  std::vector<std::pair<size_t, std::pair<Id, Id>>> order;
  for (const auto& [pair, count] : common) order.push_back({count, pair});
  std::stable_sort(order.begin(), order.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  std::map<Id, Id> first_of;
  std::map<Id, Id> taken;
  for (const auto& [count, pair] : order)
    if (!taken.contains(pair.first) && !first_of.contains(pair.second))
      taken[pair.first] = first_of[pair.second] = pair.first;
  return first_of;
}

std::string told(Id object) {
  return object == 0 ? "a false cluster" : object_name(object);
}

}  // namespace

std::string ReasonResult::summary() const {
  std::string text =
      fmt::format("{} with {} reasoned anew", counted(scenes, "scene"), counted(observations, "observation"));
  if (skipped > let_go)
    text += fmt::format("; {} left out, of which no evidence was kept", counted(skipped - let_go, "scene"));
  if (let_go > 0 && from)
    text += fmt::format("; from {} on: the evidence of {} was let go", format_time(*from),
                        counted(let_go, "scene"));
  if (!unplaced.empty()) text += fmt::format("; without a place: {}", fmt::join(unplaced, ", "));
  return text;
}

Json ReasonResult::report() const {
  return {{"scenes", scenes},
          {"observations", observations},
          {"skipped", skipped},
          {"let_go", let_go},
          {"facts", facts},
          {"unplaced", unplaced},
          {"from", from ? Json(format_time(*from)) : Json()}};
}

ReasonResult reason(const Store& from, const std::filesystem::path& other,
                    const belief::BeliefOptions& options, const WriteOptions& write, Progress& progress,
                    const KnownIdentities& known) {
  const std::vector<SceneRow> scenes = from.scenes();
  ReasonResult result;
  for (const SceneRow& scene : scenes) result.let_go += from.reasoning_discarded(scene.id) ? 1 : 0;
  if (result.let_go > 0 && result.let_go == scenes.size())
    throw Error("the evidence of all scenes was let go: nothing can be reasoned about anew",
                {from.name(), 0, {}}, "loci-memory retain --keep-reasoning erased it");
  create_atomically(other, {from.path()}, [&](const std::filesystem::path& made) {
    reason_into(from, scenes, made, options, write, progress, known, result);
  });
  return result;
}

HistoryDifference compare_histories(const Store& first, const Store& second) {
  HistoryDifference difference;
  const auto scenes_first = by_moment(first), scenes_second = by_moment(second);
  std::map<std::pair<Id, Id>, size_t> common;
  std::vector<HistoryDifference::Observation> all;
  for (const auto& [moment, scene] : scenes_first) {
    const auto found = scenes_second.find(moment);
    if (found == scenes_second.end()) {
      ++difference.scenes_unmatched;
      continue;
    }
    const std::map<int64_t, Id> there = objects_in(second, found->second.id);
    for (const auto& [number, object] : objects_in(first, scene.id)) {
      const auto other = there.find(number);
      if (other == there.end()) continue;
      all.push_back({scene.id, scene.time, number, object, other->second});
      if (object != 0 && other->second != 0) ++common[{object, other->second}];
    }
  }
  for (const auto& [moment, scene] : scenes_second)
    difference.scenes_unmatched += scenes_first.contains(moment) ? 0 : 1;
  const std::map<Id, Id> first_of = paired(common);
  for (const HistoryDifference::Observation& o : all) {
    const auto known = first_of.find(o.second);
    const bool same = o.second == 0 ? o.first == 0 : known != first_of.end() && known->second == o.first;
    if (!same) difference.observations.push_back(o);
  }
  difference.compared = all.size();
  difference.objects_first = first.objects().size();
  difference.objects_second = second.objects().size();
  for (const EventRow& event : first.events()) ++difference.events[to_text(event.kind)].first;
  for (const EventRow& event : second.events()) ++difference.events[to_text(event.kind)].second;
  return difference;
}

std::string HistoryDifference::text() const {
  std::string out =
      fmt::format("{} of {} observations are taken for other objects; {} objects here, {} there\n",
                  observations.size(), compared, objects_first, objects_second);
  if (scenes_unmatched > 0) out += fmt::format("{} scenes are in one of them only\n", scenes_unmatched);
  for (const auto& [kind, counts] : events)
    if (counts.first != counts.second)
      out += fmt::format("{}: {} here, {} there\n", kind, counts.first, counts.second);
  for (const Observation& o : observations)
    out += fmt::format("scene {} at {}, observation {}: {} here, {} there\n", o.scene, format_time(o.time),
                       o.number, told(o.first), told(o.second));
  return out;
}

Json HistoryDifference::to_json() const {
  const auto name = [](Id object) { return object == 0 ? Json() : Json(object_name(object)); };
  Json list = Json::array();
  for (const Observation& o : observations)
    list.push_back({{"scene", o.scene},
                    {"time", format_time(o.time)},
                    {"observation", o.number},
                    {"here", name(o.first)},
                    {"there", name(o.second)}});
  Json kinds = Json::object();
  for (const auto& [kind, counts] : events) kinds[kind] = {{"here", counts.first}, {"there", counts.second}};
  return {{"compared", compared},
          {"different", observations.size()},
          {"objects", {{"here", objects_first}, {"there", objects_second}}},
          {"events", kinds},
          {"scenes_unmatched", scenes_unmatched},
          {"observations", list}};
}

}  // namespace loci::memory
