#include "memory/recorder/recorder.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "memory/recorder/checkpoint.h"
#include "memory/recorder/depth_sample.h"
#include "memory/recorder/fading.h"
#include "memory/recorder/news.h"
#include "memory/recorder/scene_reasoning.h"
#include "memory/store/feature_structures.h"
#include "memory/store/scene_images.h"

namespace loci::memory {
namespace {

constexpr double kMinShare = 0.01;
constexpr double kMinChosen = 1e-6;
constexpr double kHidden = 0.99;  ///< what was so probably out of sight makes no row of association
constexpr double kPlaceSeen = 0.01;

}  // namespace

/// One scene on its way into the memory.
class Recorder::Writing {
 public:
  Writing(Recorder& recorder, const SceneRecord& record, ResolvedScene resolved)
      : recorder_(recorder),
        record_(record),
        transaction_(recorder.store_, recorder.run_),
        state_(std::move(resolved.after)) {
    result_.update = std::move(resolved.update);
    evidence_ = std::move(resolved.scene);
  }

  RecordedScene run() {
    add_scene();
    add_places();
    add_observations();
    add_objects();
    add_associations();
    add_events();
    add_joint_events();
    add_beliefs();
    add_visibility();
    belief::Decisions decisions = belief::decisions_of(result_.update);
    belief::SceneMatrices matrices = belief::matrices_of(result_.update, decisions);
    save_reasoning(transaction_, result_.scene,
                   {std::move(evidence_), std::move(decisions), std::move(matrices)});
    recorder_.checkpoint_.save(transaction_, result_.scene, state_);
    transaction_.commit();
    recorder_.checkpoint_.committed();
    keep_told();
    recorder_.state_ = std::move(state_);
    recorder_.last_joints_ = record_.row.joints;
    recorder_.places_.merge(new_places_);
    recorder_.next_observation_ += static_cast<Id>(result_.observations.size());
    return std::move(result_);
  }

 private:
  Bitemporal clock(std::optional<TimeNs> valid_from = {}) const {
    Bitemporal clock;
    clock.valid_from = valid_from.value_or(record_.row.time);
    clock.source = record_.source;
    return clock;
  }

  [[noreturn]] void another_writer(const std::string& what, Id id, Id expected) const {
    throw Error(what + " " + std::to_string(id) + " was to be " + std::to_string(expected),
                {recorder_.store_.path().string(), 0, {}},
                "another program has written to this memory meanwhile");
  }

  std::optional<Id> blob(const BlobRecord& record) {
    if (record.bytes.empty()) return std::nullopt;
    return transaction_.add_blob(record.bytes, record.media);
  }

  void add_scene() {
    SceneRow row = record_.row;
    if (!record_.view.depth.empty()) {
      const DepthSample small = depth_sample(record_.view.depth);
      row.depth = transaction_.add_blob(small.bytes, kDepthThumbnailMedia);
      row.depth_width = small.width;
      row.depth_height = small.height;
      if (record_.kinds.size() == record_.view.depth.size())
        row.pixel_kinds = transaction_.add_blob(kind_sample(record_.kinds), kPixelKindsMedia);
    }
    row.image = blob(record_.image);
    result_.scene = transaction_.add_scene(row);
    for (size_t i = 0; i < record_.log.size(); ++i) {
      LogRow line = record_.log[i];
      line.scene = result_.scene;
      line.number = static_cast<int64_t>(i);
      transaction_.add_log(line);
    }
  }

  void add_places() {
    for (const PlaceRow& place : record_.places)
      if (!this->place(place.name)) new_places_[place.name] = transaction_.add_place(place);
  }

  std::optional<Id> place(const std::string& name) const {
    if (const auto known = recorder_.places_.find(name); known != recorder_.places_.end())
      return known->second;
    const auto fresh = new_places_.find(name);
    return fresh == new_places_.end() ? std::nullopt : std::optional<Id>(fresh->second);
  }

  void add_observations() {
    FeatureStructureWriter structures(transaction_, result_.scene);
    for (size_t i = 0; i < record_.observations.size(); ++i) {
      const ObservationRecord& observation = record_.observations[i];
      ObservationRow row = observation.row;
      row.scene = result_.scene;
      row.number = static_cast<int64_t>(i);
      row.place = place(observation.evidence.place);
      row.crop = blob(observation.crop);
      row.mask = blob(observation.mask);
      row.cloud = blob(observation.cloud);
      const Id id = transaction_.add_observation(row);
      result_.observations.push_back(id);
      if (id != evidence_.observations[i].id) another_writer("observation", id, evidence_.observations[i].id);
      add_annotations(observation.annotations, observation.structures, id, structures);
    }
    add_annotations(record_.annotations, record_.structures, std::nullopt, structures);
  }

  void add_annotations(const std::vector<AnnotationRecord>& annotations,
                       const std::vector<perception::cas::FeatureStructure>& others,
                       std::optional<Id> observation, FeatureStructureWriter& structures) {
    for (const AnnotationRecord& annotation : annotations) {
      AnnotationRow row;
      row.scene = result_.scene;
      row.observation = observation;
      row.type = annotation.type;
      row.value = annotation.value;
      row.confidence = annotation.confidence;
      if (annotation.structure) row.feature_structure = structures.add(annotation.structure, observation);
      transaction_.add_annotation(row);
    }
    for (const perception::cas::FeatureStructure& structure : others) structures.add(structure, observation);
  }

  void add_objects() {
    for (const belief::Confirmed& confirmed : result_.update.confirmed) {
      ObjectRow row;
      row.clock = clock(confirmed.first_seen);
      const Id id = transaction_.add_object(row);
      recorder_.max_object_ = std::max(recorder_.max_object_, id);
      if (id != confirmed.object) another_writer("object", id, confirmed.object);
      for (const belief::PendingObservation& sighting : confirmed.earlier) {
        AssociationRow association;
        association.scene = recorder_.store_.observation(sighting.observation).scene;
        association.observation = sighting.observation;
        association.object = id;
        association.explanation = sighting.first ? Explanation::appear : Explanation::stay;
        association.probability = sighting.probability;
        association.chosen = true;
        association.clock = clock(sighting.time);
        transaction_.add_association(association);
      }
    }
  }

  void add_association(std::optional<Id> observation, std::optional<Id> object, Explanation explanation,
                       double probability, bool chosen) {
    if (probability < kMinShare && !chosen) return;
    AssociationRow row;
    row.scene = result_.scene;
    row.observation = observation;
    row.object = object;
    row.explanation = explanation;
    // Probability 0 means taken back: what was acted on is a sighting, however improbable by itself.
    row.probability = std::clamp(probability, chosen ? kMinChosen : 0.0, 1.0);
    row.chosen = chosen;
    row.clock = clock();
    transaction_.add_association(row);
  }

  void add_associations() {
    for (size_t k = 0; k < result_.observations.size(); ++k) {
      const belief::ObservationOutcome& outcome = result_.update.observations[k];
      const Id observation = result_.observations[k];
      for (const belief::PartnerProbability& share : outcome.partners) {
        if (share.object == 0) continue;  // tentative: told when it is confirmed
        const bool chosen = outcome.key == share.key;
        for (const auto& [explanation, probability] :
             {std::pair{Explanation::stay, share.stay}, std::pair{Explanation::move, share.move},
              std::pair{Explanation::newview, share.newview}})
          add_association(observation, share.object, explanation, probability,
                          chosen && outcome.explanation == explanation);
      }
      const bool appeared = outcome.explanation == Explanation::appear && outcome.object != 0;
      if (appeared) add_association(observation, outcome.object, Explanation::appear, outcome.appear, true);
      add_association(observation, std::nullopt, Explanation::clutter, outcome.clutter,
                      outcome.explanation == Explanation::clutter);
    }
    for (const belief::ObjectOutcome& outcome : result_.update.objects) {
      if (outcome.object == 0 || is_old_news(outcome) || outcome.hidden >= kHidden) continue;
      for (const auto& [explanation, probability] :
           {std::pair{Explanation::disappear, outcome.disappear},
            std::pair{Explanation::missed, outcome.missed}, std::pair{Explanation::hidden, outcome.hidden}})
        add_association(std::nullopt, outcome.object, explanation, probability,
                        outcome.explanation == explanation);
    }
  }

  /// Known to be gone before, and still not seen.
  bool is_old_news(const belief::ObjectOutcome& outcome) const {
    const auto before = recorder_.told_.find(outcome.object);
    return before != recorder_.told_.end() && before->second.status == ObjectStatus::gone && !seen(outcome);
  }

  static bool seen(const belief::ObjectOutcome& outcome) {
    return outcome.explanation == Explanation::stay || outcome.explanation == Explanation::move ||
           outcome.explanation == Explanation::newview;
  }

  void add_events() {
    for (const belief::Event& event : result_.update.events) {
      EventRow row;
      row.scene = result_.scene;
      row.kind = event.kind;
      row.object = event.object;
      if (event.observation) row.observation = result_.observations[*event.observation];
      row.place = place(event.to_place);
      row.from_place = place(event.from_place);
      if (event.to) row.position = event.to->centre;
      if (event.from) row.from_position = event.from->centre;
      row.probability = std::clamp(event.probability, 0.0, 1.0);
      row.since = event.since;
      row.clock = clock(event.time);
      transaction_.add_event(row);
    }
  }

  void add_joint_events() {
    if (!recorder_.state_.last_scene) return;  // nothing to compare with
    for (const auto& [joint, position] : record_.row.joints) {
      const auto before = recorder_.last_joints_.find(joint);
      const double from = before == recorder_.last_joints_.end() ? 0.0 : before->second;
      if (!joint_moved(from, position)) continue;
      EventRow row;
      row.scene = result_.scene;
      row.kind = EventKind::joint_changed;
      row.joint = joint;
      row.joint_position = position;
      row.from_joint_position = from;
      for (const PlaceRow& candidate : record_.places)
        if (candidate.joint == joint) row.place = place(candidate.name);
      row.since = recorder_.state_.last_scene;
      row.clock = clock();
      transaction_.add_event(row);
    }
  }

  bool was_seen_now(const belief::ProtoObject& object) const {
    return !result_.observations.empty() && object.last_observation >= result_.observations.front() &&
           object.last_observation <= result_.observations.back();
  }

  void add_beliefs() {
    for (const belief::Confirmed& confirmed : result_.update.confirmed) add_first_belief(confirmed);
    std::map<Id, const belief::ObjectOutcome*> outcomes;
    for (const belief::ObjectOutcome& outcome : result_.update.objects) outcomes[outcome.object] = &outcome;
    for (const belief::ProtoObject& object : state_.objects) {
      if (object.id == 0) continue;
      const auto outcome = outcomes.find(object.id);
      add_belief(object, outcome == outcomes.end() ? nullptr : outcome->second);
    }
  }

  /// What the memory says about an object, with this scene's changes; nullptr = nothing yet.
  const BeliefRow* told_about(Id object) const {
    if (const auto now = told_.find(object); now != told_.end()) return &now->second;
    const auto before = recorder_.told_.find(object);
    return before == recorder_.told_.end() ? nullptr : &before->second;
  }

  void add_belief(const belief::ProtoObject& object, const belief::ObjectOutcome* outcome) {
    const bool seen_now = was_seen_now(object), gone = object.status == belief::Status::gone;
    const BeliefRow* before = told_about(object.id);
    BeliefRow row = before == nullptr ? BeliefRow() : *before;
    row.object = object.id;
    row.scene = result_.scene;
    row.probability =
        std::clamp(outcome == nullptr ? object.probability_here : outcome->probability_here, 0.0, 1.0);
    row.status = gone                 ? ObjectStatus::gone
                 : seen_now           ? ObjectStatus::seen
                 : outcome == nullptr ? ObjectStatus::out_of_view
                                      : unseen_status(outcome->visibility);
    if (const std::optional<Id> now = place(object.place)) row.place = now;
    const belief::AxisBox box = belief::box_in_map(object, record_.place_poses);
    row.position = box.centre;
    row.size = box.size;
    row.sigma = std::sqrt(object.variance);
    row.clock = clock();
    if (seen_now) fill_sighting(row, object);
    row.probability_then = row.probability;
    row.then = record_.row.time;
    const bool looks_new = outcome != nullptr && outcome->explanation == Explanation::newview;
    if (before == nullptr || looks_new || is_news(*before, row, seen_now)) {
      row.fade_s.reset();
      row.fade_to.reset();
      if (!gone) {
        const Fading fading = fading_of(object, state_, recorder_.options_);
        row.fade_s = fading.time_s;
        row.fade_to = fading.share;
      }
      row.id = transaction_.add_belief(row);
      told_[object.id] = row;
    } else if (seen_now) {
      BeliefRow& told = told_[object.id] = *before;
      told.probability_then = 1;
      told.then = row.then;
      told.last_scene = row.last_scene;
      told.last_observation = row.last_observation;
    }
  }

  /// Only of objects that the belief still has.
  void keep_told() {
    for (auto& [object, row] : told_) recorder_.told_[object] = std::move(row);
    if (recorder_.told_.size() <= state_.objects.size()) return;
    std::set<Id> believed;
    for (const belief::ProtoObject& object : state_.objects) believed.insert(object.id);
    std::erase_if(recorder_.told_, [&](const auto& one) { return !believed.contains(one.first); });
  }

  void fill_sighting(BeliefRow& row, const belief::ProtoObject& object) {
    row.last_scene = result_.scene;
    row.last_observation = object.last_observation;
    for (size_t k = 0; k < result_.observations.size(); ++k) {
      if (result_.observations[k] != object.last_observation) continue;
      const ObservationRecord& observation = record_.observations[k];
      if (observation.evidence.partial && row.hsv) continue;  // a whole view says more about its colour
      row.hsv = observation.row.hsv;
      row.color = observation.row.color;
    }
  }

  /// What is believed from the first sighting on, where the object was confirmed only later.
  void add_first_belief(const belief::Confirmed& confirmed) {
    if (confirmed.earlier.empty()) return;
    const belief::PendingObservation& first = confirmed.earlier.front();
    const ObservationRow observation = recorder_.store_.observation(first.observation);
    BeliefRow row;
    row.object = confirmed.object;
    row.scene = observation.scene;
    row.status = ObjectStatus::seen;
    row.place = observation.place;
    row.position = observation.position;
    row.size = observation.size;
    row.last_scene = observation.scene;
    row.last_observation = observation.id;
    row.hsv = observation.hsv;
    row.color = observation.color;
    row.clock = clock(first.time);
    row.id = transaction_.add_belief(row);
    row.probability_then = 1;
    row.then = first.time;
    told_[confirmed.object] = row;
  }

  /// Only of what was looked for: sightings are associations, and everything else was out of view.
  void add_visibility() {
    for (const belief::ObjectOutcome& outcome : result_.update.objects) {
      if (outcome.object == 0 || is_old_news(outcome) || seen(outcome)) continue;
      VisibilityRow row;
      row.scene = result_.scene;
      row.object = outcome.object;
      row.status = unseen_status(outcome.visibility);
      if (row.status == ObjectStatus::out_of_view) continue;
      row.probability = unseen_probability(outcome.visibility, row.status);
      transaction_.add_visibility(row);
    }
    for (const PlaceRow& place_row : record_.places) add_place_visibility(place_row);
  }

  void add_place_visibility(const PlaceRow& place_row) {
    if (record_.view.observed) {
      for (const belief::ObservedPlace& observed : *record_.view.observed)
        if (observed.name == place_row.name) add_look(place_row, observed.fraction);
      return;
    }
    if (record_.view.depth.empty() || place_row.outline.empty() || !place_row.height) return;
    Isometry3d now_from_outline = Isometry3d::Identity();
    for (const belief::PlacePose& pose : record_.place_poses)
      if (pose.name == place_row.name && place_row.map_from_place)
        now_from_outline = pose.map_from_place * place_row.map_from_place->inverse();
    std::vector<Vector3d> outline;
    for (const Vector2d& corner : place_row.outline)
      outline.push_back(now_from_outline * Vector3d(corner.x(), corner.y(), *place_row.height));
    add_look(place_row,
             belief::observed_fraction(record_.view, outline, 0.05, recorder_.options_.visibility));
  }

  void add_look(const PlaceRow& place_row, double fraction) {
    if (fraction < kPlaceSeen) return;  // no row: not observed
    transaction_.add_visibility({0, result_.scene, std::nullopt, *place(place_row.name), ObjectStatus::seen,
                                 std::nullopt, std::min(1.0, fraction)});
  }

  Recorder& recorder_;
  const SceneRecord& record_;
  SceneTransaction transaction_;
  belief::BeliefState state_;
  belief::Scene evidence_;
  RecordedScene result_;
  std::map<std::string, Id> new_places_;
  std::map<Id, BeliefRow> told_;  ///< of which this scene changes something
};

Recorder::Recorder(Store& store, Id run, const belief::BeliefOptions& options)
    : store_(store), run_(run), options_(options) {
  take_up();
}

void Recorder::take_up() {
  state_ = load_belief(store_);
  checkpoint_.reset();
  told_.clear();
  for (const belief::ProtoObject& object : state_.objects)
    if (object.id != 0)
      if (std::optional<BeliefRow> row = store_.belief(object.id)) told_[object.id] = std::move(*row);
  max_object_ = store_.max_object_id();
  places_.clear();
  for (const PlaceRow& place : store_.places()) places_[place.name] = place.id;
  next_observation_ = store_.max_observation_id() + 1;
  last_joints_.clear();
  if (const std::optional<SceneRow> last = store_.last_scene()) last_joints_ = last->joints;
}

ResolvedScene Recorder::resolve(const SceneRecord& scene) const {
  ResolvedScene resolved;
  resolved.scene = evidence_of(scene, next_observation_);
  resolved.after = state_;
  // Numbers that other writers gave to objects are not given again.
  resolved.after.next_id = std::max(resolved.after.next_id, max_object_ + 1);
  resolved.update = belief::advance(resolved.after, resolved.scene, options_);
  return resolved;
}

RecordedScene Recorder::record(const SceneRecord& scene, ResolvedScene resolved) {
  return Writing(*this, scene, std::move(resolved)).run();
}

RecordedScene Recorder::record(const SceneRecord& scene) {
  ResolvedScene resolved;
  resolved.scene = evidence_of(scene, next_observation_);
  resolved.after = std::move(state_);
  resolved.after.next_id = std::max(resolved.after.next_id, max_object_ + 1);
  std::optional<TimeNs> last = resolved.after.last_scene;
  state_ = {};
  state_.last_scene = last;  // what the writing needs of it
  try {
    resolved.update = belief::advance(resolved.after, resolved.scene, options_);
    return record(scene, std::move(resolved));
  } catch (...) {
    take_up();  // the memory has it as it was
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

}  // namespace loci::memory
