#include <algorithm>
#include <cmath>
#include <set>

#include "memory/recorder/recorder.h"
#include "memory/recorder/scene_reasoning.h"
#include "memory/store/feature_structures.h"
#include "memory/store/scene_images.h"

namespace loci::memory {
namespace {

constexpr double kMinShare = 0.01;
constexpr double kMinChosen = 1e-6;
constexpr double kHidden = 0.99;  ///< objects more probably out of sight get no row of association
constexpr double kPlaceSeen = 0.01;

// Smaller changes do not create a row of belief; the schema documents them.
constexpr double kMinProbabilityChange = 0.05;
constexpr double kMinShift_m = 0.005;  ///< and the standard deviation
constexpr double kMinResize_m = 0.01;
constexpr double kMinResizeShare = 0.1;
constexpr double kJointMoved = 0.01;  ///< metres or radians

/// Whether a reader of the memory would get another answer with a row of belief of its own. `before`: the
/// last row.
bool is_significant_change(const BeliefRow& before, const BeliefRow& row, bool seen_now) {
  const bool gone = row.status == ObjectStatus::gone;
  if (gone != (before.status == ObjectStatus::gone)) return true;
  if (row.place != before.place || !before.position || !before.size) return true;
  if ((*row.position - *before.position).norm() > std::max(kMinShift_m, before.sigma.value_or(0)))
    return true;
  const Eigen::Array3d resized = (*row.size - *before.size).array().abs();
  if ((resized > kMinResize_m + kMinResizeShare * before.size->array()).any()) return true;
  const double expected = seen_now ? 1.0 : faded(before, row.then);
  return !gone && std::abs(row.probability - expected) > kMinProbabilityChange;
}

bool joint_moved(double from, double to) {
  return std::abs(to - from) > kJointMoved;
}

/// Status of an object that was not observed: missed, out_of_view or hidden.
ObjectStatus unobserved_status(const belief::Visibility& v) {
  if (v.observed() >= v.out_of_view && v.observed() >= v.hidden + v.unmeasured) return ObjectStatus::missed;
  return v.out_of_view >= v.hidden + v.unmeasured ? ObjectStatus::out_of_view : ObjectStatus::hidden;
}

double unobserved_probability(const belief::Visibility& v, ObjectStatus status) {
  const double share = status == ObjectStatus::missed        ? v.observed()
                       : status == ObjectStatus::out_of_view ? v.out_of_view
                                                             : v.hidden + v.unmeasured;
  return std::clamp(share, 0.0, 1.0);
}

/// The curve is exact at this loss, since most objects are observed again before they have faded further.
constexpr double kFirstLoss = 0.05;

/// How the probability that an object is where it was observed fades without views: after t seconds it is
/// p * (share + (1 - share) * exp(-t / time_s)).
struct Fading {
  double time_s = 0, share = 1;
};

/// The interaction model as a curve of that form, exact after the first loss and after six times move_time_s.
Fading fading_of(const belief::ProtoObject& object, const belief::BeliefState& state,
                 const belief::BeliefOptions& options) {
  const belief::InteractionKey key = belief::interaction_key(object);
  const double age = state.exposure_s - object.last_seen_exposure_s;
  const auto left = [&](double seconds) {
    return 1 - state.interaction.probability(key, age, age + seconds, options);
  };
  double early = 0, late = 6 * options.move_time_s;
  Fading fading{options.move_time_s, left(late)};
  if (fading.share > 0.999) return fading;  // hardly at all
  const double level = std::max(1 - kFirstLoss, (1 + fading.share) / 2);
  while (late - early > 0.01 * late) {
    const double middle = (early + late) / 2;
    (left(middle) > level ? early : late) = middle;
  }
  fading.time_s = -late / std::log((level - fading.share) / (1 - fading.share));
  return fading;
}

/// Depth image reduced to a thumbnail.
struct DepthSample {
  int width = 0, height = 0;
  std::string bytes;
};

int step_of(const cv::Mat& image) {
  return std::max(1, (std::max(image.cols, image.rows) + 159) / 160);
}

/// Every n-th pixel, so that the longer side has at most 160; where that has no measurement, the first
/// measured one of its block.
DepthSample depth_sample(const cv::Mat& depth) {
  const int step = step_of(depth);
  DepthSample small{depth.cols / step, depth.rows / step, {}};
  std::vector<float> values;
  for (int row = 0; row < small.height; ++row) {
    for (int column = 0; column < small.width; ++column) {
      const int v = row * step + step / 2, u = column * step + step / 2;
      float value = depth.at<float>(v, u);
      for (int i = 0; i < step * step && !std::isfinite(value); ++i)
        value = depth.at<float>(row * step + i / step, column * step + i % step);
      values.push_back(std::isfinite(value) ? value : 0.0F);
    }
  }
  small.bytes = encode_depth_thumbnail(values);
  return small;
}

/// The pixel kinds of the same samples, as bytes of pixel_kinds().
std::string kind_sample(const cv::Mat& kinds) {
  const int step = step_of(kinds);
  std::string bytes;
  for (int row = 0; row < kinds.rows / step; ++row)
    for (int column = 0; column < kinds.cols / step; ++column) {
      uint8_t kind = kinds.at<uint8_t>(row * step + step / 2, column * step + step / 2);
      for (int i = 0; i < step * step && kind == 0; ++i)
        kind = kinds.at<uint8_t>(row * step + i / step, column * step + i % step);
      bytes.push_back(static_cast<char>(kind));
    }
  return bytes;
}

}  // namespace

/// Writes one scene.
class Recorder::SceneWriter {
 public:
  SceneWriter(Recorder& recorder, const SceneRecord& record, ResolvedScene resolved)
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
    update_stored_beliefs();
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

  [[noreturn]] void refuse_other_writer(const std::string& what, Id id, Id expected) const {
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
      if (id != evidence_.observations[i].id)
        refuse_other_writer("observation", id, evidence_.observations[i].id);
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
      if (id != confirmed.object) refuse_other_writer("object", id, confirmed.object);
      for (const belief::PendingObservation& pending : confirmed.earlier) {
        AssociationRow association;
        association.scene = recorder_.store_.observation(pending.observation).scene;
        association.observation = pending.observation;
        association.object = id;
        association.explanation = pending.first ? Explanation::appear : Explanation::stay;
        association.probability = pending.probability;
        association.chosen = true;
        association.clock = clock(pending.time);
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
    // Probability 0 means revoked: the MAP hypothesis is recorded, however improbable by itself.
    row.probability = std::clamp(probability, chosen ? kMinChosen : 0.0, 1.0);
    row.chosen = chosen;
    row.clock = clock();
    transaction_.add_association(row);
  }

  void add_associations() {
    for (size_t k = 0; k < result_.observations.size(); ++k) {
      const belief::ObservationOutcome& outcome = result_.update.observations[k];
      const Id observation = result_.observations[k];
      for (const belief::PartnerProbability& partner : outcome.partners) {
        if (partner.object == 0) continue;  // tentative: recorded when it is confirmed
        const bool chosen = outcome.key == partner.key;
        for (const auto& [explanation, probability] :
             {std::pair{Explanation::stay, partner.stay}, std::pair{Explanation::move, partner.move},
              std::pair{Explanation::newview, partner.newview}})
          add_association(observation, partner.object, explanation, probability,
                          chosen && outcome.explanation == explanation);
      }
      const bool appeared = outcome.explanation == Explanation::appear && outcome.object != 0;
      if (appeared) add_association(observation, outcome.object, Explanation::appear, outcome.appear, true);
      add_association(observation, std::nullopt, Explanation::clutter, outcome.clutter,
                      outcome.explanation == Explanation::clutter);
    }
    for (const belief::ObjectOutcome& outcome : result_.update.objects) {
      if (outcome.object == 0 || is_known_to_be_gone(outcome) || outcome.hidden >= kHidden) continue;
      for (const auto& [explanation, probability] :
           {std::pair{Explanation::disappear, outcome.disappear},
            std::pair{Explanation::missed, outcome.missed}, std::pair{Explanation::hidden, outcome.hidden}})
        add_association(std::nullopt, outcome.object, explanation, probability,
                        outcome.explanation == explanation);
    }
  }

  /// Gone before the scene, and not observed in it.
  bool is_known_to_be_gone(const belief::ObjectOutcome& outcome) const {
    const auto before = recorder_.stored_beliefs_.find(outcome.object);
    return before != recorder_.stored_beliefs_.end() && before->second.status == ObjectStatus::gone &&
           !seen(outcome);
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

  /// The last row of belief of an object, this scene included; nullptr = none.
  const BeliefRow* last_belief(Id object) const {
    if (const auto now = new_beliefs_.find(object); now != new_beliefs_.end()) return &now->second;
    const auto before = recorder_.stored_beliefs_.find(object);
    return before == recorder_.stored_beliefs_.end() ? nullptr : &before->second;
  }

  void add_belief(const belief::ProtoObject& object, const belief::ObjectOutcome* outcome) {
    const bool seen_now = was_seen_now(object), gone = object.status == belief::Status::gone;
    const BeliefRow* before = last_belief(object.id);
    BeliefRow row = before == nullptr ? BeliefRow() : *before;
    row.object = object.id;
    row.scene = result_.scene;
    row.probability =
        std::clamp(outcome == nullptr ? object.probability_here : outcome->probability_here, 0.0, 1.0);
    row.status = gone                 ? ObjectStatus::gone
                 : seen_now           ? ObjectStatus::seen
                 : outcome == nullptr ? ObjectStatus::out_of_view
                                      : unobserved_status(outcome->visibility);
    if (const std::optional<Id> now = place(object.place)) row.place = now;
    const belief::AxisBox box = belief::box_in_map(object, record_.place_poses);
    row.position = box.centre;
    row.size = box.size;
    row.sigma = std::sqrt(object.variance);
    row.clock = clock();
    if (seen_now) fill_observation(row, object);
    row.probability_then = row.probability;
    row.then = record_.row.time;
    const bool new_appearance = outcome != nullptr && outcome->explanation == Explanation::newview;
    if (before == nullptr || new_appearance || is_significant_change(*before, row, seen_now)) {
      row.fade_s.reset();
      row.fade_to.reset();
      if (!gone) {
        const Fading fading = fading_of(object, state_, recorder_.options_);
        row.fade_s = fading.time_s;
        row.fade_to = fading.share;
      }
      row.id = transaction_.add_belief(row);
      new_beliefs_[object.id] = row;
    } else if (seen_now) {
      BeliefRow& stored = new_beliefs_[object.id] = *before;
      stored.probability_then = 1;
      stored.then = row.then;
      stored.last_scene = row.last_scene;
      stored.last_observation = row.last_observation;
    }
  }

  /// Of believed objects only.
  void update_stored_beliefs() {
    for (auto& [object, row] : new_beliefs_) recorder_.stored_beliefs_[object] = std::move(row);
    if (recorder_.stored_beliefs_.size() <= state_.objects.size()) return;
    std::set<Id> believed;
    for (const belief::ProtoObject& object : state_.objects) believed.insert(object.id);
    std::erase_if(recorder_.stored_beliefs_, [&](const auto& one) { return !believed.contains(one.first); });
  }

  void fill_observation(BeliefRow& row, const belief::ProtoObject& object) {
    row.last_scene = result_.scene;
    row.last_observation = object.last_observation;
    for (size_t k = 0; k < result_.observations.size(); ++k) {
      if (result_.observations[k] != object.last_observation) continue;
      const ObservationRecord& observation = record_.observations[k];
      if (observation.evidence.partial && row.hsv) continue;  // a whole view is better evidence of the colour
      row.hsv = observation.row.hsv;
      row.color = observation.row.color;
    }
  }

  /// Row of belief from the first observation of an object that was confirmed later.
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
    new_beliefs_[confirmed.object] = row;
  }

  /// Of objects whose spot was observed in vain: observations are associations, all others were out of view.
  void add_visibility() {
    for (const belief::ObjectOutcome& outcome : result_.update.objects) {
      if (outcome.object == 0 || is_known_to_be_gone(outcome) || seen(outcome)) continue;
      VisibilityRow row;
      row.scene = result_.scene;
      row.object = outcome.object;
      row.status = unobserved_status(outcome.visibility);
      if (row.status == ObjectStatus::out_of_view) continue;
      row.probability = unobserved_probability(outcome.visibility, row.status);
      transaction_.add_visibility(row);
    }
    for (const PlaceRow& place_row : record_.places) add_place_visibility(place_row);
  }

  void add_place_visibility(const PlaceRow& place_row) {
    if (record_.view.observed) {
      for (const belief::ObservedPlace& observed : *record_.view.observed)
        if (observed.name == place_row.name) add_place_fraction(place_row, observed.fraction);
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
    add_place_fraction(place_row,
                       belief::observed_fraction(record_.view, outline, 0.05, recorder_.options_.visibility));
  }

  void add_place_fraction(const PlaceRow& place_row, double fraction) {
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
  std::map<Id, BeliefRow> new_beliefs_;  ///< changed by this scene
};

RecordedScene Recorder::record(const SceneRecord& scene, ResolvedScene resolved) {
  return SceneWriter(*this, scene, std::move(resolved)).run();
}

}  // namespace loci::memory
