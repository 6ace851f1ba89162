// Which observations are of one object: merge and split.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <functional>
#include <map>
#include <set>

#include "mapping/base/text/json.h"
#include "mapping/base/time_limits.h"
#include "memory/catalogue/catalogue.h"
#include "memory/edits/edit_run.h"
#include "memory/recorder/checkpoint.h"
#include "memory/store/facts.h"

namespace loci::memory {
namespace {

void require_object(const Store& store, Id object) {
  const auto objects = store.objects();
  if (std::none_of(objects.begin(), objects.end(), [&](const ObjectRow& row) { return row.id == object; }))
    refuse(store, fmt::format("there is no {}", object_name(object)), "loci-memory objects lists them");
}

/// When an object was seen first, and its number: in this order objects are older.
std::pair<TimeNs, Id> first_seen(const Store& store, Id object) {
  const std::vector<ObjectObservation> seen = store.observations_of(object);
  return {seen.empty() ? kMaxTime : seen.front().time, object};
}

/// Error when the merged object was never seen, or the two were seen in one scene.
void require_separate(const Store& store, const std::vector<ObjectObservation>& kept, Id remaining, Id merged,
                      const std::vector<ObjectObservation>& moved) {
  if (moved.empty() || kept.empty())
    refuse(store, object_name(moved.empty() ? merged : remaining) + " was never seen",
           "loci-memory objects lists them");
  std::set<Id> scenes;
  for (const ObjectObservation& observed : kept) scenes.insert(observed.association.scene);
  for (const ObjectObservation& observed : moved)
    if (scenes.contains(observed.association.scene))
      refuse(store,
             fmt::format("{} and {} were seen together in scene {}: they are two", object_name(remaining),
                         object_name(merged), observed.association.scene),
             "loci-memory edit split removes a wrong observation first");
}

std::vector<EventRow> events_of(const Store& store, Id object, std::optional<TimeNs> from = {}) {
  std::vector<EventRow> events = store.events({}, from);
  std::erase_if(events, [&](const EventRow& event) { return event.object != object; });
  return events;
}

/// A row of belief as that of another object.
BeliefRow belief_of(const BeliefRow& belief, Id object) {
  BeliefRow row = correction_of(belief);
  row.object = object;
  row.probability = belief.probability_then;
  return row;
}

/// The events of a split object as those of the new one, which appeared with its first observation.
void add_split_events(SceneTransaction& rows, const std::vector<EventRow>& events, Id object,
                      const ObjectObservation& first) {
  bool appeared = false;
  for (const EventRow& event : events) {
    EventRow row = correction_of(event);
    row.object = object;
    if (event.clock.valid_from == first.time && !appeared) {
      row.kind = EventKind::appeared;
      row.from_place.reset();
      row.from_position.reset();
      appeared = true;
    }
    rows.add_event(row);
  }
  if (appeared) return;
  EventRow event;
  event.scene = first.association.scene;
  event.kind = EventKind::appeared;
  event.object = object;
  event.observation = first.association.observation;
  event.place = first.observation.place;
  event.position = first.observation.position;
  event.clock = {.valid_from = first.time, .source = "user"};
  rows.add_event(event);
}

// ---- Without evidence the rows are given to the other object as they are.

/// Which of two objects, taken for one, was seen last at a time.
class LastSeen {
 public:
  LastSeen(Id one, const std::vector<ObjectObservation>& of_one, Id other,
           const std::vector<ObjectObservation>& of_other) {
    for (const ObjectObservation& seen : of_one) by_time_[seen.time] = one;
    for (const ObjectObservation& seen : of_other) by_time_[seen.time] = other;
  }
  /// 0 = neither yet.
  Id at(TimeNs time) const {
    const auto next = by_time_.upper_bound(time);
    return next == by_time_.begin() ? 0 : std::prev(next)->second;
  }
  /// Times at which another one is seen than before.
  std::vector<std::pair<TimeNs, Id>> changes() const {
    std::vector<std::pair<TimeNs, Id>> changes;
    for (const auto& [time, object] : by_time_)
      if (changes.empty() || changes.back().second != object) changes.emplace_back(time, object);
    return changes;
  }

 private:
  std::map<TimeNs, Id> by_time_;
};

/// Two objects are one: at each time what is believed of the one that was seen last holds.
void merge_beliefs(const Store& store, SceneTransaction& rows, Id remaining, Id merged,
                   const LastSeen& last_seen) {
  std::set<std::pair<TimeNs, Id>> begun;
  for (const Id object : {remaining, merged})
    for (const BeliefRow& belief : store.belief_history(object)) {
      const TimeNs time = belief.clock.valid_from;
      begun.emplace(time, object);
      if (last_seen.at(time) != object)
        rows.add_belief(retraction_of(belief, rows.known()));
      else if (object == merged)
        rows.add_belief(belief_of(belief, remaining));
    }
  for (const auto& [time, object] : last_seen.changes()) {
    if (begun.contains({time, object})) continue;
    std::optional<BeliefRow> belief = store.belief(object, {time, std::nullopt});
    if (!belief) continue;
    belief->object = remaining;
    belief->scene = belief->last_scene;
    belief->clock = {.valid_from = time, .source = "user"};
    rows.add_belief(*belief);
  }
}

void merge_rows(const Store& store, SceneTransaction& rows, Id remaining,
                const std::vector<ObjectObservation>& kept, Id merged,
                const std::vector<ObjectObservation>& moved) {
  const LastSeen last_seen(remaining, kept, merged, moved);
  const std::optional<ObjectObservation> before =
      store.last_observation_before(remaining, moved.front().time, {});
  for (const ObjectObservation& observed : moved) {
    AssociationRow row = correction_of(observed.association);
    row.object = remaining;
    rows.add_association(row);
  }
  merge_beliefs(store, rows, remaining, merged, last_seen);
  for (const EventRow& event : events_of(store, remaining))
    if (last_seen.at(event.clock.valid_from) == merged) rows.add_event(retraction_of(event, rows.known()));
  for (const EventRow& event : events_of(store, merged)) {
    if (last_seen.at(event.clock.valid_from) == remaining) {
      rows.add_event(retraction_of(event, rows.known()));
      continue;
    }
    EventRow row = correction_of(event);
    row.object = remaining;
    if (event.kind == EventKind::appeared && before) {  // it was known: it moved
      row.kind = EventKind::moved;
      row.from_place = before->observation.place;
      row.from_position = before->observation.position;
      row.since = before->time;
    }
    rows.add_event(row);
  }
}

void split_rows(const Store& store, SceneTransaction& rows, Id object,
                const std::vector<ObjectObservation>& later, Id made) {
  const TimeNs first = later.front().time;
  std::vector<BeliefRow> beliefs = store.belief_history(object);
  std::erase_if(beliefs, [&](const BeliefRow& row) { return row.clock.valid_from < first; });
  const std::optional<BeliefRow> held = store.belief(object, {first, std::nullopt});
  const std::vector<EventRow> events = events_of(store, object, first);
  ObjectRow row;
  row.clock.valid_from = first;
  row.clock.source = "user";
  if (rows.add_object(row) != made) throw store.error("another object was added meanwhile", "try again");
  for (const ObjectObservation& observed : later) {
    AssociationRow association = correction_of(observed.association);
    association.object = made;
    if (observed.time == first) association.explanation = Explanation::appear;
    rows.add_association(association);
  }
  // Rows of belief are only added for significant changes: the belief at the split continues as that of the
  // new object.
  if (held && (beliefs.empty() || beliefs.front().clock.valid_from > first)) {
    BeliefRow belief = *held;
    belief.object = made;
    belief.scene = later.front().association.scene;
    belief.clock = {.valid_from = first, .source = "user"};
    rows.add_belief(belief);
  }
  for (const BeliefRow& belief : beliefs) rows.add_belief(belief_of(belief, made));
  add_split_events(rows, events, made, later.front());
}

// ---- With evidence they are reasoned about anew.

/// What people say of the identity of observations.
struct IdentityEdit {
  std::string text = {};
  std::map<Id, std::vector<Id>> groups = {};  ///< observations by the object that they are of
  TimeNs from = 0;                            ///< of the first observation that changes
  std::vector<FactRow> facts = {};            ///< that go with it
  std::vector<std::string> notes = {};        ///< what came of them
};

std::vector<Id> ids_of(const std::vector<ObjectObservation>& list) {
  std::vector<Id> ids;
  for (const ObjectObservation& observed : list) ids.push_back(observed.observation.id);
  return ids;
}

/// Objects of which something is said.
std::map<Id, std::string> named_objects(const Store& store) {
  std::map<Id, std::string> named;
  for (const FactRow& fact : store.facts())
    if (fact.object) {
      std::string& text = named[*fact.object];
      text += fmt::format("{}{} {}", text.empty() ? "" : ", ", fact.key, *fact.value);
    }
  return named;
}

/// What is said of objects of which nothing is left.
std::set<std::string> unplaced_facts(const Store& store) {
  std::set<std::string> notes;
  for (const auto& [object, facts] : named_objects(store))
    if (!store.belief(object))
      notes.insert(fmt::format("{} ({}) has no observation left", object_name(object), facts));
  return notes;
}

/// Gives what is said of an object to the one that it is. Of a key with one value the statement that was made
/// last holds, and a note says so. What catalogues say nobody said: they are applied anew.
void merge_facts(const Store& store, Id remaining, Id merged, IdentityEdit& edit) {
  std::vector<FactRow> facts = store.facts();
  std::erase_if(facts, [](const FactRow& fact) { return fact.clock.source == kCatalogueSource; });
  for (const FactRow& given : facts) {
    if (given.object != merged) continue;
    edit.facts.push_back(correction_of(given));
    edit.facts.back().object = remaining;
    if (!has_one_value(given.key)) continue;
    const auto kept = std::ranges::find_if(
        facts, [&](const FactRow& fact) { return fact.object == remaining && fact.key == given.key; });
    if (kept == facts.end()) continue;
    const bool is_newer = given.clock.known_from > kept->clock.known_from;
    const FactRow &holds = is_newer ? given : *kept, &yields = is_newer ? *kept : given;
    if (is_newer) edit.facts.push_back(correction_of(yields));
    edit.facts.back().value.reset();
    if (holds.value != yields.value)
      edit.notes.push_back(
          fmt::format("its {} is {}, as was said last, not {}", given.key, *holds.value, *yields.value));
  }
}

/// Corrects identities. `relabel` adds the rows where there is no evidence to reason with.
Edit correct_identity(Store& store, const IdentityEdit& edit,
                      const std::function<void(SceneTransaction&)>& relabel, Progress& progress) {
  const bool with_evidence = store.scenes_without_reasoning() == 0;
  const EditList before = edits(store);
  const std::set<std::string> unplaced_before = unplaced_facts(store);
  Revision revision{store.scenes({}, edit.from, edit.from).front().id, 0,
                    known_identities(store, before.done)};
  Json configuration = identity_json(edit.groups);
  configuration["text"] = edit.text;
  if (with_evidence) configuration["last_scene"] = store.last_scene()->id;
  for (const auto& [object, observations] : edit.groups)
    for (const Id observation : observations) revision.known[observation] = object;
  EditRun run(store, configuration);
  SceneTransaction rows(store, run.id());
  rows.postpone_derived();
  for (const FactRow& fact : edit.facts) rows.add_fact(fact);
  if (with_evidence) {
    for (const Edit& undone : before.undone) drop_kept_belief(rows, undone.run);  // it cannot be redone
    keep_belief(rows, store, run.id());
    revise(store, rows, revision, progress);
  } else {
    relabel(rows);
  }
  rows.commit();
  apply_catalogues(store);
  Edit made = run.finish();
  std::vector<std::string> notes = edit.notes;
  std::ranges::set_difference(unplaced_facts(store), unplaced_before, std::back_inserter(notes));
  if (!with_evidence)
    notes.emplace_back("without the evidence of all scenes nothing else was reasoned about anew");
  made.note = fmt::format("{}", fmt::join(notes, "; "));
  return made;
}

}  // namespace

Edit merge_objects(Store& store, Id one, Id other, Progress& progress) {
  if (one == other) refuse(store, object_name(one) + " is itself", "name two objects");
  require_object(store, one);
  require_object(store, other);
  const Id remaining = std::min(first_seen(store, one), first_seen(store, other)).second,
           merged = remaining == one ? other : one;
  const std::vector<ObjectObservation> kept = store.observations_of(remaining),
                                       moved = store.observations_of(merged);
  require_separate(store, kept, remaining, merged, moved);
  IdentityEdit edit{.text = fmt::format("{} is {}", object_name(merged), object_name(remaining)),
                    .groups = {{remaining, ids_of(kept)}},
                    .from = moved.front().time};
  for (const Id observation : ids_of(moved)) edit.groups[remaining].push_back(observation);
  merge_facts(store, remaining, merged, edit);
  return correct_identity(
      store, edit, [&](SceneTransaction& rows) { merge_rows(store, rows, remaining, kept, merged, moved); },
      progress);
}

Edit split_object(Store& store, Id object, TimeNs from, Progress& progress) {
  require_object(store, object);
  const std::vector<ObjectObservation> later = store.observations_of(object, {}, from);
  if (later.empty() || !store.last_observation_before(object, from, {}))
    refuse(store,
           fmt::format("{} was {} {}", object_name(object),
                       later.empty() ? "not seen from" : "first seen not before",
                       store.time_zone().format(from)),
           "loci-memory history shows when it was seen");
  const TimeNs first = later.front().time;
  const Id made = store.max_object_id() + 1;
  const IdentityEdit edit{
      .text = fmt::format("{} is {} from {} on", object_name(object), object_name(made),
                          store.time_zone().format(first)),
      .groups = {{object, ids_of(store.observations_of(object, {}, {}, first - 1))}, {made, ids_of(later)}},
      .from = first};
  return correct_identity(
      store, edit, [&](SceneTransaction& rows) { split_rows(store, rows, object, later, made); }, progress);
}

}  // namespace loci::memory
