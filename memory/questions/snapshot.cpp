#include "memory/questions/snapshot.h"

#include <algorithm>

#include "memory/questions/environment_parts.h"
#include "memory/questions/names/seen_colors.h"
#include "memory/questions/smoothing.h"

namespace loci::memory {

std::optional<Vector3d> centre_of(const PlaceRow& place) {
  if (place.outline.empty()) {
    if (!place.map_from_place) return std::nullopt;
    return place.map_from_place->translation();
  }
  Vector2d mean = Vector2d::Zero();
  for (const Vector2d& corner : place.outline) mean += corner / static_cast<double>(place.outline.size());
  return Vector3d(mean.x(), mean.y(), place.height.value_or(0));
}

bool is_believed_at(const BeliefRow& belief, Id place) {
  return belief.place == place && belief.status != ObjectStatus::gone && belief.probability >= 0.5;
}

std::optional<BelievedBox> believed_box(const BeliefRow& belief, const ObservationRow* seen) {
  const bool turned = seen != nullptr && seen->map_from_box;
  if (!belief.position && !turned) return std::nullopt;
  BelievedBox box{turned ? *seen->map_from_box : Isometry3d::Identity(), belief.size};
  if (seen != nullptr && seen->size)
    box.size = belief.size ? turned_as(*belief.size, *seen->size) : *seen->size;
  if (belief.position) box.map_from_box.translation() = *belief.position;
  return box;
}

Snapshot::Reads::Reads(const Store& of, const AsOf& when)
    : store(of),
      as_of(when),
      moment(of),
      places(of.places()),
      facts(of.facts(when)),
      taxonomy(Taxonomy::of(of, when)),
      motions(of) {
  rename_places(places, facts);
  for (const FactRow& fact : facts)
    if (fact.object && fact.value)
      stated[{*fact.object, fact.key == "color" ? "colour" : fact.key}] = *fact.value;
  for (const RecordingRow& recording : of.recordings()) recordings[recording.id] = recording.name;
}

std::shared_ptr<Snapshot::Reads> Snapshot::reads_of(const Store& store, const AsOf& as_of) {
  // While one lives, its transaction keeps what is read as it was; a writer sees its own changes.
  thread_local std::vector<std::weak_ptr<Reads>> living;
  std::erase_if(living, [](const std::weak_ptr<Reads>& reads) { return reads.expired(); });
  for (const std::weak_ptr<Reads>& one : living)
    if (std::shared_ptr<Reads> reads = one.lock(); !store.writable() && &reads->store == &store &&
                                                   reads->as_of.at == as_of.at &&
                                                   reads->as_of.known_at == as_of.known_at)
      return reads;
  auto reads = std::make_shared<Reads>(store, as_of);
  living.push_back(reads);
  return reads;
}

Snapshot::Snapshot(const Store& store, const AsOf& as_of)
    : store_(store), as_of_(as_of), reads_(reads_of(store, as_of)) {}

const std::vector<BeliefRow>& Snapshot::beliefs() const& {
  if (!reads_->beliefs) {
    reads_->beliefs = store_.beliefs(as_of_);
    for (BeliefRow& row : *reads_->beliefs) smooth(row);
  }
  return *reads_->beliefs;
}

void Snapshot::smooth(BeliefRow& row) const {
  row.probability = smoothed_probability(store_, row, as_of_);
}

Isometry3d Snapshot::place_motion(const PlaceRow& place, const SceneRow& scene) const {
  if (place.map == scene.map) return Isometry3d::Identity();
  for (const PlaceRow& row : store_.places())  // as the map calls them
    if (row.id == place.id) return reads_->motions.motion(row, scene.map);
  return Isometry3d::Identity();
}

const PartNames& Snapshot::part_names() const& {
  if (!reads_->part_names) reads_->part_names = loci::memory::part_names(store_, as_of_.known_at);
  return *reads_->part_names;
}

const std::vector<EnvironmentPart>& Snapshot::parts() const& {
  if (!reads_->parts) reads_->parts = std::make_shared<const std::vector<EnvironmentPart>>(all_parts(*this));
  return *reads_->parts;
}

const std::vector<SceneRow>& Snapshot::scenes() const& {
  if (!reads_->scenes) reads_->scenes = store_.scenes(as_of_);
  return *reads_->scenes;
}

const BeliefRow* Snapshot::belief(Id object) const {
  if (reads_->beliefs) {
    const auto found = std::lower_bound(reads_->beliefs->begin(), reads_->beliefs->end(), object,
                                        [](const BeliefRow& row, Id id) { return row.object < id; });
    return found != reads_->beliefs->end() && found->object == object ? &*found : nullptr;
  }
  const auto [slot, fresh] = reads_->belief_of.try_emplace(object);
  if (fresh) {
    slot->second = store_.belief(object, as_of_);
    if (slot->second) smooth(*slot->second);
  }
  return slot->second ? &*slot->second : nullptr;
}

const SceneRow* Snapshot::scene(Id id) const {
  const auto [slot, fresh] = reads_->scene_of.try_emplace(id);
  if (fresh) {
    slot->second = store_.scene(id);
    const bool later = (as_of_.at && slot->second->time > *as_of_.at) ||
                       (as_of_.known_at && slot->second->known_from > *as_of_.known_at);
    if (later) slot->second.reset();
  }
  return slot->second ? &*slot->second : nullptr;
}

std::string Snapshot::joint_name(const std::string& joint) const {
  const auto names_place = [](const FactRow& fact) { return fact.place && fact.key == kPlaceNameKey; };
  // The map is read only where something in it may have a name.
  if (part_names().links.empty() && std::ranges::none_of(facts(), names_place))
    return part_names().joint(joint);
  for (const EnvironmentPart& part : parts())
    if (part.motion && part.motion->map_joint == joint) return part.motion->joint;
  return part_names().joint(joint);
}

std::optional<PlaceRef> Snapshot::place_moved_by(const std::string& joint) const {
  std::optional<PlaceRef> moved;
  for (const PlaceRow& row : places()) {
    if (row.joint != joint) continue;
    if (moved) return std::nullopt;
    moved = PlaceRef{row.id, row.name, row.container};
  }
  return moved;
}

SceneRef Snapshot::scene_ref(const SceneRow& scene) const {
  SceneRef ref{.scene = scene.id, .time = scene.time, .recording = {}, .frame = scene.frame_index};
  if (scene.recording)
    if (const auto found = reads_->recordings.find(*scene.recording); found != reads_->recordings.end())
      ref.recording = found->second;
  return ref;
}

std::optional<SceneRef> Snapshot::scene_ref(std::optional<Id> id) const {
  if (!id) return std::nullopt;
  const SceneRow* row = scene(*id);
  return scene_ref(row == nullptr ? store_.scene(*id) : *row);
}

ObjectRef Snapshot::object_ref(Id object) const {
  ObjectRef ref{.id = object, .name = object_name(object)};
  std::optional<std::string> product, class_name;
  for (const FactRow& fact : reads_->facts) {
    if (fact.object != object) continue;
    if (fact.key == "alias") ref.aliases.push_back(*fact.value);
    if (fact.key == "product") product = fact.value;
    if (fact.key == "class") class_name = fact.value;
  }
  ref.label = !ref.aliases.empty() ? ref.aliases.front() : product ? product : class_name;
  if (!ref.label) ref.label = annotated_name(object);
  if (const BeliefRow* row = belief(object)) {
    ref.color = color_of(*row);
    ref.size = row->size;
  }
  return ref;
}

std::optional<std::string> Snapshot::stated(Id object, const std::string& property) const {
  const auto found = reads_->stated.find({object, property});
  return found == reads_->stated.end() ? std::nullopt : std::optional(found->second);
}

std::optional<std::string> Snapshot::color_of(const BeliefRow& row) const {
  const std::optional<std::string> said = stated(row.object, "colour");
  return said ? said : row.color;
}

const std::vector<std::string>& Snapshot::seen_colors(Id object) const {
  const auto [slot, fresh] = reads_->seen_colors.try_emplace(object);
  if (fresh) slot->second = memory::seen_colors(store_, object, as_of_);
  return slot->second;
}

std::optional<std::string> Snapshot::annotated_name(Id object) const {
  const ClassExperts::Judgement& judgement = experts().judgement(object);
  if (judgement.product) return judgement.product;
  const std::optional<ClassVerdict>& verdict = judgement.verdict;
  return verdict && !verdict->name.empty() ? std::optional(verdict->name) : std::nullopt;
}

const ClassExperts& Snapshot::experts() const {
  // What an object is does not change: of the past it is called as all looks know it now.
  if (!reads_->experts) reads_->experts.emplace(store_, reads_->facts, AsOf{{}, as_of_.known_at});
  return *reads_->experts;
}

std::optional<PlaceRef> Snapshot::place_ref(std::optional<Id> place) const {
  if (!place) return std::nullopt;
  for (const PlaceRow& row : reads_->places)
    if (row.id == *place) return PlaceRef{row.id, row.name, row.container};
  return std::nullopt;
}

ObjectBelief Snapshot::object_belief(Id object) const {
  return object_belief(*belief(object));
}

ObjectBelief Snapshot::object_belief(const BeliefRow& row) const {
  const Store::ObservationCount sightings = store_.count_observations(row.object, as_of_);
  ObjectBelief belief{.object = object_ref(row.object),
                      .status = row.status,
                      .probability = row.probability,
                      .in_home = row.probability + (1 - row.probability) * row.elsewhere.value_or(0),
                      .place = place_ref(row.place),
                      .position = row.position,
                      .first_seen = scene_ref(sightings.first_scene),
                      .last_seen = scene_ref(row.last_scene),
                      .sightings = sightings.count};
  if (!belief.last_seen) return belief;
  const TimeNs last_seen = belief.last_seen->time;
  std::optional<TimeNs> gone;  // since when it is not expected there
  if (row.status == ObjectStatus::gone)
    for (const BeliefRow& earlier : store_.belief_history(row.object, as_of_, last_seen))
      if (!gone && earlier.status == ObjectStatus::gone && earlier.clock.valid_from > last_seen)
        gone = earlier.clock.valid_from;
  const Store::VisibilityCounts views = store_.visibility_since(row.object, last_seen, gone, as_of_);
  belief.scenes_out_of_view = views.out_of_view;
  belief.scenes_hidden = views.hidden;
  belief.scenes_missed = views.missed;
  belief.last_missed = scene_ref(views.last_missed);
  return belief;
}

Change Snapshot::change(const EventRow& event) const {
  Change change;
  change.kind = event.kind;
  change.time = event.clock.valid_from;
  change.since = event.since;
  if (event.object) change.object = object_ref(*event.object);
  change.place = place_ref(event.place);
  change.from_place = place_ref(event.from_place);
  change.position = event.position;
  change.from_position = event.from_position;
  if (event.joint) change.joint = joint_name(*event.joint);
  change.joint_is_named = change.joint != event.joint;
  if (event.joint && !change.place) change.place = place_moved_by(*event.joint);
  change.joint_position = event.joint_position;
  change.from_joint_position = event.from_joint_position;
  change.probability = event.probability;
  change.scene = scene_ref(event.scene);
  // What appeared is believed from a later look on, which need not have seen it.
  if (change.scene && change.scene->time != change.time)
    if (const std::vector<SceneRow> then = store_.scenes(as_of_, change.time, change.time); !then.empty())
      change.scene = scene_ref(then.front());
  change.source = event.clock.source;
  return change;
}

}  // namespace loci::memory
