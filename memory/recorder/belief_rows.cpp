#include <algorithm>
#include <cmath>
#include <set>

#include "memory/belief/extents.h"
#include "memory/recorder/belief_rows.h"
#include "memory/store/scene_images.h"

namespace loci::memory {
namespace {

constexpr double kMinShare = 0.01;
constexpr double kMinChosen = 1e-6;
constexpr double kHidden = 0.99;  ///< objects more probably out of sight get no row of association

// Smaller changes do not create a row of belief; the schema documents them.
constexpr double kMinProbabilityChange = 0.05;
constexpr double kMinShift_m = 0.005;  ///< and the standard deviation
constexpr double kMinResize_m = 0.01;
constexpr double kMinResizeShare = 0.1;

/// Whether a reader of the memory would get another answer with a row of belief of its own. `before`: the
/// last row.
bool is_significant_change(const BeliefRow& before, const BeliefRow& row, bool seen_now) {
  const bool gone = row.status == ObjectStatus::gone;
  if (gone != (before.status == ObjectStatus::gone)) return true;
  if (row.place != before.place || !before.position || !before.size != !row.size) return true;
  if ((*row.position - *before.position).norm() > std::max(kMinShift_m, before.sigma.value_or(0)))
    return true;
  if (row.size) {
    const Eigen::Array3d resized = (*row.size - *before.size).array().abs();
    if ((resized > kMinResize_m + kMinResizeShare * before.size->array()).any()) return true;
  }
  const double expected = seen_now ? 1.0 : faded(before, row.then);
  return !gone && std::abs(row.probability - expected) > kMinProbabilityChange;
}

/// Status of an object that was not observed: missed, out_of_view or hidden.
ObjectStatus unobserved_status(const belief::Visibility& v) {
  if (v.observed() >= v.out_of_view && v.observed() >= v.hidden + v.unmeasured) return ObjectStatus::missed;
  return v.out_of_view >= v.hidden + v.unmeasured ? ObjectStatus::out_of_view : ObjectStatus::hidden;
}

/// What a scene showed of an object that it did not find; what it shows to have left is missed there, however
/// little of its spot is in view.
ObjectStatus unobserved_status(const belief::ObjectOutcome& outcome) {
  const bool left = outcome.explanation == Explanation::disappear;
  return left ? ObjectStatus::missed : unobserved_status(outcome.visibility);
}

/// The extents of an object that was measured before, of which a view shows a part at least: how it is turned
/// is that of the part.
Vector3d at_least(const Vector3d& known, const Vector3d& part) {
  return turned_as(known, part).cwiseMax(part);
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
  belief::InteractionKey key = belief::interaction_key(object);
  key.uses = 0;  // what its place was used for is in its present probability
  const double age = state.exposure_s - object.last_seen_exposure_s;
  const double leaves = 1 - state.interaction.moved_to(object.place, object.place);
  const auto left = [&](double seconds) {
    return 1 - leaves * state.interaction.probability(key, age, age + seconds, options);
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

class RowBuilder {
 public:
  explicit RowBuilder(const BeliefChange& change) : c_(change) {}

  BeliefRows run() {
    add_objects();
    add_associations();
    add_events();
    add_beliefs();
    add_visibility();
    return std::move(rows_);
  }

 private:
  Bitemporal clock(std::optional<TimeNs> valid_from = {}) const {
    Bitemporal clock;
    clock.valid_from = valid_from.value_or(c_.record.row.time);
    clock.source = c_.record.source;
    return clock;
  }

  std::optional<Id> place(const std::string& name) const {
    const auto known = c_.places.find(name);
    return known == c_.places.end() ? std::nullopt : std::optional(known->second);
  }

  void add_objects() {
    for (const belief::Confirmed& confirmed : c_.update.confirmed) {
      ObjectRow row;
      row.clock = clock(confirmed.first_seen);
      rows_.objects[confirmed.object] = row;
      for (const belief::PendingObservation& pending : confirmed.earlier) {
        AssociationRow association;
        association.scene = c_.store.observation(pending.observation).scene;
        association.observation = pending.observation;
        association.object = confirmed.object;
        association.explanation = pending.first ? Explanation::appear : Explanation::stay;
        association.probability = pending.probability;
        association.chosen = true;
        association.clock = clock(pending.time);
        rows_.associations.push_back(association);
      }
    }
  }

  void add_association(std::optional<Id> observation, std::optional<Id> object, Explanation explanation,
                       double probability, bool chosen) {
    if (probability < kMinShare && !chosen) return;
    AssociationRow row;
    row.scene = c_.scene;
    row.observation = observation;
    row.object = object;
    row.explanation = explanation;
    // Probability 0 means revoked: the MAP hypothesis is recorded, however improbable by itself.
    row.probability = std::clamp(probability, chosen ? kMinChosen : 0.0, 1.0);
    row.chosen = chosen;
    row.clock = clock();
    rows_.associations.push_back(row);
  }

  void add_associations() {
    for (size_t k = 0; k < c_.observations.size(); ++k) {
      const belief::ObservationOutcome& outcome = c_.update.observations[k];
      const Id observation = c_.observations[k];
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
    for (const belief::ObjectOutcome& outcome : c_.update.objects) {
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
    const auto before = c_.before.find(outcome.object);
    return before != c_.before.end() && before->second.status == ObjectStatus::gone && !seen(outcome);
  }

  static bool seen(const belief::ObjectOutcome& outcome) {
    return outcome.explanation == Explanation::stay || outcome.explanation == Explanation::move ||
           outcome.explanation == Explanation::newview;
  }

  void add_events() {
    for (const belief::Event& event : c_.update.events) {
      EventRow row;
      row.scene = c_.scene;
      row.kind = event.kind;
      row.object = event.object;
      if (event.observation) row.observation = c_.observations[*event.observation];
      row.place = place(event.to_place);
      row.from_place = place(event.from_place);
      if (event.to) row.position = event.to->centre;
      if (event.from) row.from_position = event.from->centre;
      row.probability = std::clamp(event.probability, 0.0, 1.0);
      row.since = event.since;
      if (event.kind == EventKind::appeared || event.kind == EventKind::reappeared)
        row.since = std::max({row.since, last_look_without(event), gone_from_there(event)});
      row.clock = clock(event.time);
      rows_.events.push_back(row);
    }
  }

  /// When an object that is back at its spot was found to have gone from it; unset for others.
  std::optional<TimeNs> gone_from_there(const belief::Event& event) const {
    const auto before = c_.before.find(event.object);
    if (before == c_.before.end() || before->second.status != ObjectStatus::gone || !event.to ||
        !before->second.position ||
        (*before->second.position - event.to->centre).norm() > event.to->size.norm() / 2)
      return std::nullopt;
    return before->second.clock.valid_from;
  }

  /// The last of the looks before at the place where an object came up that showed its spot without it; unset
  /// where the last ones did not. Where the place moves with a joint, the spot is not known.
  std::optional<TimeNs> last_look_without(const belief::Event& event) const {
    constexpr int kMaxLooks = 8;
    const std::optional<Id> at = place(event.to_place);
    const auto known = std::ranges::find(c_.record.places, event.to_place, &PlaceRow::name);
    if (!at || !event.to || (known != c_.record.places.end() && known->joint)) return std::nullopt;
    TimeNs before = event.time - 1;
    for (int i = 0; i < kMaxLooks; ++i) {
      const std::optional<VisibilityRow> view = c_.store.last_visibility(*at, {.at = before});
      if (!view) return std::nullopt;
      const SceneRow scene = c_.store.scene(view->scene);
      if (shows_empty(scene, *event.to)) return scene.time;
      before = scene.time - 1;
    }
    return std::nullopt;
  }

  /// Whether a scene saw behind the axis of a box and behind its side towards the camera: the middle of a
  /// bowl is empty. Both at three quarters of its height, where the support behind is farther away than
  /// below, and bottles are still as wide as their box.
  bool shows_empty(const SceneRow& scene, const belief::AxisBox& box) const {
    const auto depth = DepthThumbnail::of(c_.store, scene);
    if (!depth) return false;
    const Vector2d towards = (scene.map_from_camera->translation() - box.centre).head<2>();
    const double radii = towards.cwiseQuotient(box.size.head<2>().cwiseMax(1e-3) / 2).norm();
    const Vector3d axis = box.centre + Vector3d(0, 0, box.size.z() / 4);
    Vector3d near = axis;
    if (radii > 1) near.head<2>() += towards / radii;  // on the ellipse within the box
    return depth->spot_status(axis) == SpotStatus::seen_empty &&
           depth->spot_status(near) == SpotStatus::seen_empty;
  }

  bool was_seen_now(const belief::ProtoObject& object) const {
    return !c_.observations.empty() && object.last_observation >= c_.observations.front() &&
           object.last_observation <= c_.observations.back();
  }

  void add_beliefs() {
    for (const belief::Confirmed& confirmed : c_.update.confirmed) add_first_belief(confirmed);
    std::map<Id, const belief::ObjectOutcome*> outcomes;
    for (const belief::ObjectOutcome& outcome : c_.update.objects) outcomes[outcome.object] = &outcome;
    for (const belief::ProtoObject& object : c_.after.objects) {
      if (object.id == 0) continue;
      const auto outcome = outcomes.find(object.id);
      add_belief(object, outcome == outcomes.end() ? nullptr : outcome->second);
    }
  }

  /// The last row of belief of an object, this scene included; nullptr = none.
  const BeliefRow* last_belief(Id object) const {
    if (const auto now = rows_.last.find(object); now != rows_.last.end()) return &now->second;
    const auto before = c_.before.find(object);
    return before == c_.before.end() ? nullptr : &before->second;
  }

  void add_belief(const belief::ProtoObject& object, const belief::ObjectOutcome* outcome) {
    const bool seen_now = was_seen_now(object), gone = object.status == belief::Status::gone;
    const BeliefRow* before = last_belief(object.id);
    BeliefRow row = before == nullptr ? BeliefRow() : *before;
    row.object = object.id;
    row.scene = c_.scene;
    row.probability = std::clamp(belief::probability_on_place(object, c_.after, c_.options), 0.0, 1.0);
    row.status = gone                 ? ObjectStatus::gone
                 : seen_now           ? ObjectStatus::seen
                 : outcome == nullptr ? ObjectStatus::out_of_view
                                      : unobserved_status(outcome->visibility);
    if (const std::optional<Id> now = place(object.place)) row.place = now;
    const belief::AxisBox box = belief::box_in_map(object, c_.place_poses);
    row.position = box.centre;
    if (const std::optional<Vector3d> extents = belief::extents_of(object, row.size))
      row.size = extents;
    else if (object.has_size)
      row.size = object.partial && row.size ? at_least(*row.size, box.size) : box.size;
    row.sigma = std::sqrt(object.variance);
    row.clock = clock();
    if (seen_now) fill_observation(row, object);
    row.elsewhere = c_.after.interaction.elsewhere();
    row.probability_then = row.probability;
    row.then = c_.record.row.time;
    const bool new_appearance = outcome != nullptr && outcome->explanation == Explanation::newview;
    if (before == nullptr || new_appearance || is_significant_change(*before, row, seen_now)) {
      row.fade_s.reset();
      row.fade_to.reset();
      if (!gone) {
        const Fading fading = fading_of(object, c_.after, c_.options);
        row.fade_s = fading.time_s;
        row.fade_to = fading.share;
      }
      rows_.beliefs.push_back(row);
      rows_.last[object.id] = row;
    } else if (seen_now) {
      BeliefRow& stored = rows_.last[object.id] = *before;
      stored.probability_then = 1;
      stored.then = row.then;
      stored.last_scene = row.last_scene;
      stored.last_observation = row.last_observation;
    }
  }

  void fill_observation(BeliefRow& row, const belief::ProtoObject& object) {
    row.last_scene = c_.scene;
    row.last_observation = object.last_observation;
    for (size_t k = 0; k < c_.observations.size(); ++k) {
      if (c_.observations[k] != object.last_observation) continue;
      const ObservationRecord& observation = c_.record.observations[k];
      if (observation.evidence.partial && row.hsv) continue;  // a whole view is better evidence of the colour
      row.hsv = observation.row.hsv;
      row.color = observation.row.color;
    }
  }

  /// Row of belief from the first observation of an object that was confirmed later.
  void add_first_belief(const belief::Confirmed& confirmed) {
    if (confirmed.earlier.empty()) return;
    const belief::PendingObservation& first = confirmed.earlier.front();
    const ObservationRow observation = c_.store.observation(first.observation);
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
    rows_.beliefs.push_back(row);
    row.probability_then = 1;
    row.then = first.time;
    rows_.last[confirmed.object] = row;
  }

  /// Of objects whose spot was observed in vain: observations are associations, all others were out of view.
  void add_visibility() {
    for (const belief::ObjectOutcome& outcome : c_.update.objects) {
      if (outcome.object == 0 || is_known_to_be_gone(outcome) || seen(outcome)) continue;
      VisibilityRow row;
      row.scene = c_.scene;
      row.object = outcome.object;
      row.status = unobserved_status(outcome);
      if (row.status == ObjectStatus::out_of_view) continue;
      row.probability = unobserved_probability(outcome.visibility, row.status);
      rows_.visibility.push_back(row);
    }
  }

  const BeliefChange& c_;
  BeliefRows rows_;
};

}  // namespace

BeliefRows belief_rows(const BeliefChange& change) {
  return RowBuilder(change).run();
}

void update_last(std::map<Id, BeliefRow>& before, BeliefRows& rows, const belief::BeliefState& state) {
  for (auto& [object, row] : rows.last) before[object] = std::move(row);
  if (before.size() <= state.objects.size()) return;
  std::set<Id> believed;
  for (const belief::ProtoObject& object : state.objects) believed.insert(object.id);
  std::erase_if(before, [&](const auto& one) { return !believed.contains(one.first); });
}

}  // namespace loci::memory
