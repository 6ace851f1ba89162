#include "memory/reasoning/revise.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "mapping/base/progress.h"
#include "mapping/base/text/json.h"
#include "memory/belief/hindsight.h"
#include "memory/reasoning/stored_scene.h"
#include "memory/recorder/belief_rows.h"
#include "memory/recorder/checkpoint.h"
#include "memory/recorder/recorder.h"

namespace loci::memory {
namespace {

/// Smaller differences of a probability are not reported.
constexpr double kSameProbability = 0.01;
constexpr double kSamePosition_m = 0.001;

bool same(double a, double b) {
  return std::abs(a - b) < kSameProbability;
}

bool same(const std::optional<double>& a, const std::optional<double>& b) {
  return a.has_value() == b.has_value() && (!a || std::abs(*a - *b) <= 0.02 * std::max(1.0, std::abs(*a)));
}

bool same(const std::optional<Vector3d>& a, const std::optional<Vector3d>& b) {
  return a.has_value() == b.has_value() && (!a || (*a - *b).norm() < kSamePosition_m);
}

bool same(const AssociationRow& a, const AssociationRow& b) {
  return a.observation == b.observation && a.object == b.object && a.explanation == b.explanation &&
         a.chosen == b.chosen && same(a.probability, b.probability);
}

bool same(const EventRow& a, const EventRow& b) {
  return a.kind == b.kind && a.object == b.object && a.observation == b.observation && a.place == b.place &&
         a.from_place == b.from_place && a.since == b.since && a.clock.valid_from == b.clock.valid_from &&
         same(a.position, b.position) && same(a.from_position, b.from_position) &&
         same(a.probability, b.probability);
}

bool same(const BeliefRow& a, const BeliefRow& b) {
  return a.object == b.object && a.status == b.status && a.place == b.place &&
         a.last_observation == b.last_observation && a.clock.valid_from == b.clock.valid_from &&
         a.color == b.color && same(a.position, b.position) && same(a.size, b.size) &&
         same(a.fade_s, b.fade_s) && same(a.fade_to, b.fade_to) && same(a.elsewhere, b.elsewhere) &&
         same(a.probability, b.probability);
}

/// Adds rows in place of those known now.
template <class Row, class Add>
void replace(const std::vector<Row>& known, std::vector<Row> fresh, TimeNs now, Add add) {
  for (size_t i = 0; i < std::max(known.size(), fresh.size()); ++i) {
    if (i >= fresh.size()) {
      add(retraction_of(known[i], now));
      continue;
    }
    if (i < known.size()) fresh[i].clock.supersedes = known[i].id;
    add(fresh[i]);
  }
}

/// Leaves rows as they are that are found again.
template <class Row>
void leave_same(std::vector<Row>& known, std::vector<Row>& fresh) {
  std::erase_if(fresh, [&](const Row& row) {
    const auto old = std::ranges::find_if(known, [&](const Row& other) { return same(row, other); });
    if (old == known.end()) return false;
    known.erase(old);
    return true;
  });
}

/// The rows of one observation, or of one object that was not observed, are one distribution: those that are
/// the same are left as they are.
void leave_distributions(std::vector<AssociationRow>& known, std::vector<AssociationRow>& fresh) {
  using Key = std::pair<Id, Id>;
  const auto key = [](const AssociationRow& row) {
    return row.observation ? Key(*row.observation, 0) : Key(0, row.object.value_or(0));
  };
  std::map<Key, std::pair<std::vector<const AssociationRow*>, std::vector<const AssociationRow*>>> of;
  for (const AssociationRow& row : known) of[key(row)].first.push_back(&row);
  for (const AssociationRow& row : fresh) of[key(row)].second.push_back(&row);
  std::set<Key> left;
  for (const auto& [one, rows] : of)
    if (std::ranges::is_permutation(rows.first, rows.second,
                                    [](const auto* a, const auto* b) { return same(*a, *b); }))
      left.insert(one);
  for (auto* rows : {&known, &fresh})
    std::erase_if(*rows, [&](const AssociationRow& row) { return left.contains(key(row)); });
}

/// Rows of visibility of objects have no clock: the newest holds, and one with out_of_view stands for none.
void replace(const std::vector<VisibilityRow>& known, const std::vector<VisibilityRow>& fresh, TimeNs time,
             SceneTransaction& transaction) {
  std::map<Id, VisibilityRow> before, after;
  for (const VisibilityRow& row : known)
    if (row.object) before[*row.object] = row;
  for (const VisibilityRow& row : fresh) after[*row.object] = row;
  for (auto& [object, row] : after) {
    const auto old = before.find(object);
    row.time = time;
    if (old == before.end() || old->second.status != row.status) transaction.add_visibility(row);
  }
  for (auto& [object, row] : before) {
    if (after.contains(object) || row.status == ObjectStatus::out_of_view) continue;
    row.status = ObjectStatus::out_of_view;
    row.probability.reset();
    transaction.add_visibility(row);
  }
}

class Reviser {
 public:
  Reviser(const Store& store, SceneTransaction& transaction, const Revision& revision)
      : store_(store),
        transaction_(transaction),
        revision_(revision),
        options_(load_options(store)),
        place_rows_(store.places()),
        forgotten_(store.forgotten()),
        known_(revision.known),
        probabilities_(revision.probabilities),
        next_object_(store.max_object_id() + 1) {
    for (const PlaceRow& place : place_rows_) places_[place.name] = place.id;
    for (const auto& [observation, object] : known_) known_objects_.insert(object);
    if (revision.before != nullptr)
      state_ = *revision.before;
    else if (revision.resume_after != 0)
      state_ = load_belief(store, revision.resume_after);
  }

  void run(Progress& progress) {
    const std::vector<SceneRow> scenes = store_.scenes();
    bool resumed = revision_.resume_after == 0;
    for (size_t i = 0; i < scenes.size(); ++i) {
      progress.check(static_cast<double>(i) / static_cast<double>(scenes.size()), "reasoning anew");
      if (scenes[i].id == revision_.from) {
        begin(i == 0 ? std::nullopt : std::optional(scenes[i - 1].time));
        const double done = static_cast<double>(i) / static_cast<double>(scenes.size());
        PartialProgress within(progress, done, done);  // short against the scenes that follow
        look_back(std::span(scenes).subspan(i), within);
      }
      if (resumed && !was_forgotten(forgotten_, scenes[i].time)) add(scenes[i]);
      resumed = resumed || scenes[i].id == revision_.resume_after;
    }
    write_closed(std::nullopt);
    if (const std::optional<SceneRow> last = store_.last_scene())
      BeliefCheckpoint(options_).save(transaction_, last->id, state_);
    end_review(transaction_);  // what a run left pending was looked back over, and people have the last word
  }

 private:
  struct OpenScene {
    TimeNs time = 0;
    BeliefRows rows;
  };

  /// What was believed just before the first scene that is reasoned about anew.
  void begin(std::optional<TimeNs> before) {
    anew_ = true;
    if (!before) return;
    for (const belief::ProtoObject& object : state_.objects)
      if (object.id != 0)
        if (std::optional<BeliefRow> row = store_.belief(object.id, {.at = before}))
          last_[object.id] = std::move(*row);
  }

  /// What later ones of the scenes tell of earlier ones is known, too.
  void look_back(std::span<const SceneRow> scenes, Progress& progress) {
    if (scenes.size() > kLookBack) return;
    std::vector<belief::Scene> evidence;
    for (const SceneRow& row : scenes)
      if (!was_forgotten(forgotten_, row.time)) evidence.push_back(scene_of(row, record_of(row)));
    state_.next_id = std::max(state_.next_id, next_object_);
    for (const auto& [observation, supposed] : belief::hindsight(state_, evidence, options_, progress)) {
      known_[observation] = supposed.object;
      known_objects_.insert(supposed.object);
      probabilities_[observation] = supposed.probability;
    }
  }

  SceneRecord record_of(const SceneRow& row) const {
    const std::optional<SceneReasoning> reasoning = load_reasoning(store_, row.id);
    if (!reasoning) throw store_.error(fmt::format("the evidence of scene {} was let go", row.id));
    SceneRecord record = stored_scene(store_, row, *reasoning, place_rows_);
    record.source = revision_.source;
    return record;
  }

  /// A scene as evidence, with what is known of its observations.
  belief::Scene scene_of(const SceneRow& row, const SceneRecord& record) const {
    std::vector<Id> observations;
    for (const ObservationRecord& one : record.observations) observations.push_back(one.row.id);
    belief::Scene scene = evidence_of(record);
    identify(row.id, observations, scene);
    return scene;
  }

  void add(const SceneRow& row) {
    const SceneRecord record = record_of(row);
    const belief::Scene scene = scene_of(row, record);
    std::vector<Id> observations;
    for (const belief::Observation& one : scene.observations) observations.push_back(one.id);
    state_.next_id = std::max(state_.next_id, next_object_);
    const belief::BeliefUpdate update = belief::advance(state_, scene, options_);
    if (!anew_) return;
    if (revision_.replace_reasoning) replace_reasoning(row.id, update);
    BeliefRows rows = belief_rows(
        {store_, record, scene.places, row.id, observations, update, state_, options_, places_, last_});
    update_last(last_, rows, state_);
    for (AssociationRow& association : rows.associations)
      if (association.chosen && association.observation)
        if (const auto one = probabilities_.find(*association.observation); one != probabilities_.end())
          association.probability *= one->second;
    take(row, std::move(rows));
    write_closed(oldest_open());
  }

  void replace_reasoning(Id scene, const belief::BeliefUpdate& update) {
    std::optional<SceneReasoning> reasoning = load_reasoning(store_, scene);
    reasoning->decisions = belief::decisions_of(update);
    reasoning->matrices = belief::matrices_of(update, reasoning->decisions);
    save_reasoning(transaction_, scene, *reasoning);
  }

  /// What is known of the observations beforehand, and which objects they were of.
  void identify(Id scene_id, const std::vector<Id>& observations, belief::Scene& scene) const {
    std::map<Id, Id> decided;
    for (const AssociationRow& row : store_.associations(scene_id))
      if (row.chosen && row.observation && row.probability > 0)
        decided[*row.observation] = row.object.value_or(0);
    for (size_t k = 0; k < observations.size(); ++k) {
      belief::Observation& observation = scene.observations[k];
      observation.id = observations[k];
      const auto before = decided.find(observations[k]);
      const Id object = before == decided.end() ? 0 : before->second;
      const auto known = known_.find(observations[k]);
      if (!anew_)
        observation.known_object = object;
      else if (known != known_.end())
        observation.known_object = known->second;
      else if (!known_objects_.contains(object))
        observation.former_object = object;
    }
  }

  /// Rows about earlier scenes, of objects that were confirmed later, go with these scenes.
  void take(const SceneRow& scene, BeliefRows rows) {
    OpenScene& now = open_[scene.id];
    now.time = scene.time;
    for (const AssociationRow& row : rows.associations) open_[row.scene].rows.associations.push_back(row);
    for (const BeliefRow& row : rows.beliefs) open_[*row.scene].rows.beliefs.push_back(row);
    now.rows.events = std::move(rows.events);
    now.rows.visibility = std::move(rows.visibility);
    for (const auto& [object, row] : rows.objects) {
      if (object < next_object_) continue;
      next_object_ = object + 1;
      if (transaction_.add_object(row) != object)
        throw store_.error("another object was added meanwhile", "try again");
    }
  }

  /// The time from which on rows may still be added; unset = of the next scene.
  TimeNs oldest_open() const {
    TimeNs oldest = state_.last_scene.value_or(0) + 1;
    for (const belief::ProtoObject& object : state_.objects)
      if (object.status == belief::Status::tentative && !object.pending.empty())
        oldest = std::min(oldest, object.pending.front().time);
    return oldest;
  }

  void write_closed(std::optional<TimeNs> before) {
    for (auto one = open_.begin(); one != open_.end();) {
      const bool closed = !before || one->second.time < *before;
      if (closed) write(one->first, one->second);
      one = closed ? open_.erase(one) : std::next(one);
    }
  }

  void write(Id scene, OpenScene& open) {
    const TimeNs now = transaction_.known();
    std::vector<AssociationRow> associations = store_.known_rows<AssociationRow>(scene);
    leave_distributions(associations, open.rows.associations);
    replace(associations, std::move(open.rows.associations), now,
            [&](const AssociationRow& row) { transaction_.add_association(row); });
    std::vector<EventRow> events = store_.known_rows<EventRow>(scene);
    std::erase_if(events, [](const EventRow& row) { return !row.object; });
    leave_same(events, open.rows.events);
    replace(events, std::move(open.rows.events), now,
            [&](const EventRow& row) { transaction_.add_event(row); });
    std::vector<BeliefRow> beliefs = store_.known_rows<BeliefRow>(scene);
    leave_same(beliefs, open.rows.beliefs);
    replace(beliefs, std::move(open.rows.beliefs), now,
            [&](const BeliefRow& row) { transaction_.add_belief(row); });
    replace(store_.visibility(scene), open.rows.visibility, open.time, transaction_);
  }

  const Store& store_;
  SceneTransaction& transaction_;
  const Revision& revision_;
  const belief::BeliefOptions options_;
  const std::vector<PlaceRow> place_rows_;
  const std::vector<ForgottenRow> forgotten_;
  std::map<std::string, Id> places_;
  KnownIdentities known_;
  std::map<Id, double> probabilities_;
  std::set<Id> known_objects_;
  Id next_object_;
  bool anew_ = false;
  belief::BeliefState state_;
  std::map<Id, BeliefRow> last_;
  std::map<Id, OpenScene> open_;  ///< scenes to which rows may still be added
};

constexpr const char* kIdentity = "identity";

}  // namespace

Json identity_json(const std::map<Id, std::vector<Id>>& observations_of) {
  Json list = Json::array();
  for (const auto& [object, observations] : observations_of)
    list.push_back({{"object", object}, {"observations", observations}});
  return {{kIdentity, list}};
}

void read_identities(const Json& configuration, KnownIdentities& known) {
  if (!configuration.contains(kIdentity)) return;
  for (const Json& one : configuration[kIdentity])
    for (const Json& observation : one.at("observations"))
      known[observation.get<Id>()] = one.at("object").get<Id>();
}

void revise(const Store& store, SceneTransaction& transaction, const Revision& revision, Progress& progress) {
  Reviser(store, transaction, revision).run(progress);
}

namespace {

/// Scenes as evidence, and the scene of each observation.
struct StoredEvidence {
  std::vector<belief::Scene> scenes;
  std::map<Id, Id> scene_of_observation;
};

/// The scenes after one (0 = all), unless they are more than kLookBack or another program wrote one of them.
StoredEvidence evidence_after(const Store& store, Id after) {
  std::vector<SceneRow> rows = store.scenes();
  const auto first = after == 0 ? rows.begin() : std::next(std::ranges::find(rows, after, &SceneRow::id));
  rows.erase(rows.begin(), first);
  StoredEvidence evidence;
  if (rows.size() > kLookBack) return evidence;
  const std::vector<PlaceRow> places = store.places();
  const std::vector<ForgottenRow> forgotten = store.forgotten();
  for (const SceneRow& row : rows) {
    if (was_forgotten(forgotten, row.time)) continue;
    const std::optional<SceneReasoning> reasoning = load_reasoning(store, row.id);
    if (!reasoning) return {};
    const SceneRecord record = stored_scene(store, row, *reasoning, places);
    belief::Scene& scene = evidence.scenes.emplace_back(evidence_of(record));
    for (size_t k = 0; k < record.observations.size(); ++k) {
      scene.observations[k].id = record.observations[k].row.id;
      evidence.scene_of_observation[scene.observations[k].id] = row.id;
    }
  }
  return evidence;
}

}  // namespace

size_t look_back(Store& store, Id run, Progress& progress) {
  const std::optional<PendingReview> review = load_review(store);
  if (!review) return 0;
  std::map<Id, belief::Supposition> supposed;
  SceneTransaction rows(store, run);
  if (review->contradicted) {
    const StoredEvidence evidence = evidence_after(store, review->after);
    supposed = belief::hindsight(review->before, evidence.scenes, load_options(store), progress);
    Revision revision{.resume_after = review->after, .before = &review->before, .source = kHindsight};
    for (const auto& [observation, one] : supposed) {
      revision.known[observation] = one.object;
      revision.probabilities[observation] = one.probability;
      const Id scene = evidence.scene_of_observation.at(observation);
      revision.from = revision.from == 0 ? scene : std::min(revision.from, scene);
    }
    if (revision.from != 0) {
      rows.postpone_derived();
      revise(store, rows, revision, progress);
    }
  }
  end_review(rows);
  rows.commit();
  return supposed.size();
}

}  // namespace loci::memory
