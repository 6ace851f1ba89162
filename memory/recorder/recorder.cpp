#include "memory/recorder/recorder.h"

#include <algorithm>

#include "mapping/base/text/hash.h"
#include "memory/recorder/scene_reasoning.h"

namespace loci::memory {

Recorder::Recorder(Store& store, Id run, const belief::BeliefOptions& options)
    : store_(store), run_(run), options_(options), checkpoint_(options), motions_(store) {
  load();
}

void Recorder::load() {
  state_ = load_belief(store_);
  checkpoint_.reset();
  stored_beliefs_.clear();
  for (const belief::ProtoObject& object : state_.objects)
    if (object.id != 0)
      if (std::optional<BeliefRow> row = store_.belief(object.id))
        stored_beliefs_[object.id] = std::move(*row);
  max_object_ = store_.max_object_id();
  places_.clear();
  for (const PlaceRow& place : store_.places()) places_[place.name] = place;
  next_observation_ = store_.max_observation_id() + 1;
  last_joints_.clear();
  last_map_.reset();
  last_places_.clear();
  if (const std::optional<SceneRow> last = store_.last_scene()) {
    last_map_ = last->map;
    if (std::optional<SceneReasoning> reasoning = load_reasoning(store_, last->id))
      last_places_ = std::move(reasoning->evidence.places);
  }
}

/// Objects ride on furniture that stands elsewhere in the map of the scene than in that of its place, or that
/// the scene shows elsewhere than its map has it.
belief::Scene Recorder::evidence(const SceneRecord& record) const {
  belief::Scene scene = evidence_of(record, next_observation_);
  const auto add = [&](const std::string& name, const Isometry3d& by_map) {
    const auto is_it = [&](const belief::PlacePose& pose) { return pose.name == name; };
    if (std::ranges::any_of(scene.places, is_it)) return;
    const auto moved = std::ranges::find_if(record.moved_places, is_it);
    if (moved != record.moved_places.end())
      scene.places.push_back({name, moved->map_from_place * by_map, moved->known});
    else if (is_moved(by_map))
      scene.places.push_back({name, by_map});
  };
  for (const auto& [name, place] : places_) add(name, motions_.motion(place, map_of(record.row)));
  for (const PlaceRow& place : record.places) add(place.name, Isometry3d::Identity());
  return scene;
}

ResolvedScene Recorder::resolve(const SceneRecord& scene) const {
  ResolvedScene resolved;
  resolved.scene = evidence(scene);
  resolved.after = state_;
  // Object numbers of other writers are not reused.
  resolved.after.next_id = std::max(resolved.after.next_id, max_object_ + 1);
  resolved.update = belief::advance(resolved.after, resolved.scene, options_);
  return resolved;
}

RecordedScene Recorder::record(const SceneRecord& scene) {
  ResolvedScene resolved;
  resolved.scene = evidence(scene);
  resolved.after = std::move(state_);
  resolved.after.next_id = std::max(resolved.after.next_id, max_object_ + 1);
  std::optional<TimeNs> last = resolved.after.last_scene;
  state_ = {};
  state_.last_scene = last;  // needed for joint events
  try {
    resolved.update = belief::advance(resolved.after, resolved.scene, options_);
    return record(scene, std::move(resolved));
  } catch (...) {
    load();  // the memory is unchanged
    throw;
  }
}

belief::Scene evidence_of(const SceneRecord& record, int64_t first_observation) {
  belief::Scene scene;
  scene.time = record.row.time;
  scene.seconds_to_next = record.seconds_to_next;
  scene.view = record.view;
  scene.places = record.place_poses;
  for (const ObservationRecord& observation : record.observations) {
    scene.observations.push_back(observation.evidence);
    scene.observations.back().id = first_observation++;
  }
  return scene;
}

std::string recording_fingerprint(const std::vector<FrameDigest>& frames,
                                  const std::vector<cv::Mat>& images) {
  std::string bytes;
  for (const FrameDigest& frame : frames)
    bytes += std::to_string(frame.index) + " " + std::to_string(frame.time) + "\n";
  for (const cv::Mat& image : images) {
    bytes += std::to_string(image.cols) + "x" + std::to_string(image.rows) + "\n";
    for (int row = 0; row < image.rows; ++row)
      bytes.append(reinterpret_cast<const char*>(image.ptr(row)), size_t(image.cols) * image.elemSize());
  }
  return content_hash(bytes);
}

}  // namespace loci::memory
