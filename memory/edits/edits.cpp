#include "memory/edits/edits.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <functional>
#include <map>
#include <set>

#include "mapping/base/json.h"
#include "mapping/base/text.h"
#include "mapping/world/urdf.h"
#include "memory/questions/facts.h"
#include "memory/questions/map_names.h"
#include "memory/questions/snapshot.h"
#include "memory/reasoning/reason.h"
#include "memory/recorder/checkpoint.h"
#include "memory/store/scene_transaction.h"

namespace loci::memory {
namespace {

/// A run of an edit. Its configuration has the "text" of the edit, and what is needed to reverse it. One that
/// is not finished is no edit.
class EditRun {
 public:
  EditRun(Store& store, const Json& configuration)
      : store_(store), id_(store.begin_run(kEditProgram, configuration.dump())) {}
  EditRun(const EditRun&) = delete;
  EditRun& operator=(const EditRun&) = delete;
  Id id() const { return id_; }
  void finish() { store_.finish_run(id_); }

 private:
  Store& store_;
  Id id_;
};

/// The edit that a run made.
Edit edit_of(const Store& store, Id run) {
  for (const RunRow& row : store.runs())
    if (row.id == run) {
      const Json configuration = parse_json(row.configuration, "run.configuration");
      return {run, row.started, configuration.value("text", row.program), {}};
    }
  throw store.error(fmt::format("no run {}", run));
}

/// A row of source "user" that takes the place of `row`.
template <class Row>
Row correction_of(const Row& row) {
  Row corrected = row;
  corrected.clock.supersedes = row.id;
  corrected.clock.source = "user";
  corrected.clock.known_to.reset();
  return corrected;
}

/// For each row a new one that supersedes what is known instead of it by now: the row that it superseded
/// itself, or its retraction. As a whole it says what was said before, in the words of who said it.
template <class Row>
std::vector<Row> reversed_rows(const Store& store, const std::vector<Row>& rows, TimeNs known) {
  std::vector<Row> reversed;
  for (const Row& row : rows) {
    const bool restores = row.clock.supersedes.has_value();
    Row& one = reversed.emplace_back(restores ? store.row<Row>(*row.clock.supersedes) : row);
    if (!restores || one.clock.known_to) one.clock.known_to = known;  // a retraction is never known
    one.clock.supersedes = store.current_row<Row>(row.id);
  }
  return reversed;
}

/// For each object and scene the row of visibility from before a run; one with out_of_view where there was
/// none.
std::vector<VisibilityRow> reversed_visibility(const Store& store, Id run) {
  std::vector<VisibilityRow> reversed = store.rows_of_run<VisibilityRow>(run);
  for (VisibilityRow& row : reversed) {
    if (const auto before = store.visibility_before(row)) {
      row.status = before->status;
      row.probability = before->probability;
    } else {
      row.status = ObjectStatus::out_of_view;
      row.probability.reset();
    }
  }
  return reversed;
}

/// Adds an annotation with the label of an observation.
void add_label(Store& store, Id run, Id scene, Id observation, const std::string& label) {
  SceneTransaction rows(store, run);
  rows.add_annotation(
      {.scene = scene, .observation = observation, .type = kLabelType, .value = label, .confidence = 1});
  rows.commit();
}

/// Adds a map like one of the memory, numbered in a comment so that it is the newest. What people typed stays
/// out of its text.
Id add_corrected_map(Store& store, const MapRow& like, const std::string& urdf) {
  const std::string sidecar = like.sidecar ? store.blob(*like.sidecar).bytes : std::string();
  return store.add_map(like.name, fmt::format("{}\n<!-- correction {} -->\n", urdf, store.maps().size()),
                       sidecar);
}

/// The scene after another in order of time; 0 = none.
Id scene_after(const Store& store, Id scene) {
  const std::vector<SceneRow> scenes = store.scenes();
  const auto found = std::ranges::find(scenes, scene, &SceneRow::id);
  return found == scenes.end() || found + 1 == scenes.end() ? 0 : (found + 1)->id;
}

/// What the edits say of identities, later ones over earlier ones.
KnownIdentities known_identities(const Store& store, const std::vector<Edit>& list) {
  KnownIdentities known;
  std::map<Id, std::string> configurations;
  for (RunRow& run : store.runs()) configurations[run.id] = std::move(run.configuration);
  for (const RunRow& run : store.runs())  // that came along from the memory that was reasoned about
    if (run.program == kReasonProgram)
      read_identities(parse_json(run.configuration, "run.configuration"), known);
  for (const Edit& edit : list)
    read_identities(parse_json(configurations[edit.run], "run.configuration"), known);
  return known;
}

/// Makes the belief what it was before a correction of identities; scenes that were added since are reasoned
/// about anew with the identities that are `known` now.
void return_to_belief_before(Store& store, SceneTransaction& rows, const RunRow& row, Id reversal,
                             const Json& configuration, KnownIdentities known, Progress& progress) {
  keep_belief(rows, store, reversal);
  const std::optional<Id> kept = restore_belief(rows, store, row.id);
  const Id last = kept.value_or(configuration["last_scene"].get<Id>());
  const Revision revision{scene_after(store, last), kept.value_or(0), std::move(known)};
  if (kept && revision.from == 0) return;
  if (store.scenes_without_reasoning() == 0) revise(store, rows, revision, progress);
}

/// Reverses what a run did, as a new run: rows that superseded others are superseded by them, others are
/// retracted. `known`: what is known of identities without it.
Id reverse_run(Store& store, const RunRow& row, const std::string& text, const Json& more,
               const KnownIdentities& known, Progress& progress) {
  Json configuration = parse_json(row.configuration, "run.configuration");
  for (const char* key : {"undoes", "redoes"}) configuration.erase(key);
  configuration.update(more);
  configuration["text"] = text;
  for (const char* kind : {"label", "map", "part"})
    if (configuration.contains(kind)) {
      Json& change = configuration[kind];
      std::swap(change["before"], change["after"]);
    }
  EditRun run(store, configuration);
  {
    SceneTransaction added(store, run.id());
    added.postpone_derived();
    const TimeNs now = added.known();
    for (const auto& one : reversed_rows(store, store.rows_of_run<AssociationRow>(row.id), now))
      added.add_association(one);
    for (const auto& one : reversed_rows(store, store.rows_of_run<EventRow>(row.id), now))
      added.add_event(one);
    for (const auto& one : reversed_rows(store, store.rows_of_run<FactRow>(row.id), now)) added.add_fact(one);
    for (const auto& one : reversed_rows(store, store.rows_of_run<BeliefRow>(row.id), now))
      added.add_belief(one);
    for (const VisibilityRow& one : reversed_visibility(store, row.id)) added.add_visibility(one);
    if (configuration.contains("last_scene"))
      return_to_belief_before(store, added, row, run.id(), configuration, known, progress);
    added.commit();
  }
  if (configuration.contains("label")) {
    const Json& label = configuration["label"];
    add_label(store, run.id(), label["scene"].get<Id>(), label["observation"].get<Id>(),
              label["after"].get<std::string>());
  }
  if (configuration.contains("map")) {
    const Id like = configuration["map"]["after"].get<Id>();
    for (const MapRow& map : store.maps())
      if (map.id == like) {
        add_corrected_map(store, map, store.blob(map.urdf).bytes);
        break;
      }
  }
  store.derive();
  run.finish();
  return run.id();
}

bool is_edit(const RunRow& run) {
  return run.program.starts_with(kEditProgram) || run.program.starts_with("loci-memory fact ");
}

std::string text_of(const Store& store, const RunRow& run, const Json& configuration) {
  if (configuration.contains("text")) return configuration["text"].get<std::string>();
  for (const FactRow& fact : store.rows_of_run<FactRow>(run.id))  // of `fact set` and `fact remove`
    if (fact.object)
      return fmt::format("{}: {}{}", object_name(*fact.object), fact.key,
                         fact.value ? " is " + *fact.value : " is retracted");
    else
      for (const PlaceRow& place : store.places())
        if (place.id == fact.place)
          return fmt::format("{}: {}{}", place.name, fact.key,
                             fact.value ? " is " + *fact.value : " is retracted");
  return run.program;
}

[[noreturn]] void refuse(const Store& store, const std::string& what, const std::string& hint) {
  throw store.error(what, hint);
}

void require_object(const Store& store, Id object) {
  const auto objects = store.objects();
  if (std::none_of(objects.begin(), objects.end(), [&](const ObjectRow& row) { return row.id == object; }))
    refuse(store, fmt::format("there is no {}", object_name(object)), "loci-memory objects lists them");
}

/// Reverses an edit; `others` are those that hold then.
Edit toggle(Store& store, const Edit& edit, const char* what, const std::vector<Edit>& others,
            Progress& progress) {
  RunRow row;
  for (const RunRow& run : store.runs())
    if (run.id == edit.run) row = run;
  const Id run =
      reverse_run(store, row, edit.text, {{what, edit.run}}, known_identities(store, others), progress);
  return edit_of(store, run);
}

/// Something that has a name: what the map (or who found it) calls it, and what it is called now.
struct Named {
  const char* of;  ///< place, link or joint
  std::string in_map, now;
  bool is_called(const std::string& name) const { return name == in_map || name == now; }
};

/// Places before links and joints: who names a place means what is there.
std::vector<Named> all_named(const Store& store) {
  std::vector<Named> all;
  const std::vector<PlaceRow> before = store.places(), now = named_places(store);
  for (size_t i = 0; i < before.size(); ++i) all.push_back({"place", before[i].name, now[i].name});
  const std::vector<MapRow> maps = store.maps();
  if (maps.empty()) return all;
  const mapping::World world = mapping::parse_urdf(store.blob(maps.back().urdf).bytes, maps.back().name);
  const PartNames names = part_names(store);
  for (const mapping::Link& link : world.links)
    if (std::none_of(before.begin(), before.end(),
                     [&](const PlaceRow& place) { return place.name == link.name; }))
      all.push_back({"link", link.name, names.link(link.name)});
  for (const mapping::Joint& joint : world.joints)
    all.push_back({"joint", joint.name, names.joint(joint.name)});
  return all;
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
std::vector<std::string> unplaced_facts(const Store& store) {
  std::vector<std::string> notes;
  for (const auto& [object, facts] : named_objects(store))
    if (!store.belief(object))
      notes.push_back(fmt::format("{} ({}) has no observation left", object_name(object), facts));
  return notes;
}

/// Corrects identities. `relabel` adds the rows where there is no evidence to reason with.
Edit correct_identity(Store& store, const IdentityEdit& edit,
                      const std::function<void(SceneTransaction&)>& relabel, Progress& progress) {
  const bool with_evidence = store.scenes_without_reasoning() == 0;
  const EditList before = edits(store);
  Revision revision{store.scenes({}, edit.from, edit.from).front().id, 0,
                    known_identities(store, before.done)};
  Json configuration = identity_json(edit.groups);
  configuration["text"] = edit.text;
  if (with_evidence) configuration["last_scene"] = store.last_scene()->id;
  for (const auto& [object, observations] : edit.groups)
    for (const Id observation : observations) revision.known[observation] = object;
  EditRun run(store, configuration);
  {
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
  }
  store.derive();
  run.finish();
  Edit made = edit_of(store, run.id());
  std::vector<std::string> notes = unplaced_facts(store);
  if (!with_evidence)
    notes.emplace_back("without the evidence of all scenes nothing else was reasoned about anew");
  made.note = fmt::format("{}", fmt::join(notes, "; "));
  return made;
}

}  // namespace

Progress& no_progress() {
  static NoProgress silent;
  return silent;
}

KnownIdentities known_identities(const Store& store) {
  return known_identities(store, edits(store).done);
}

EditList edits(const Store& store) {
  EditList list;
  const auto move_to = [](std::vector<Edit>& from, std::vector<Edit>& to, const Edit& now, Id turned) {
    const auto found =
        std::find_if(from.begin(), from.end(), [&](const Edit& edit) { return edit.run == turned; });
    if (found != from.end()) from.erase(found);
    to.push_back(now);
  };
  for (const RunRow& run : store.runs()) {
    if (!is_edit(run) || !run.finished) continue;
    const Json configuration = parse_json(run.configuration, "run.configuration");
    if (configuration.contains("forgotten")) continue;  // it was about something that was forgotten
    const Edit edit = {run.id, run.started, text_of(store, run, configuration), {}};
    if (configuration.contains("undoes")) {
      move_to(list.done, list.undone, edit, configuration["undoes"].get<Id>());
    } else if (configuration.contains("redoes")) {
      move_to(list.undone, list.done, edit, configuration["redoes"].get<Id>());
    } else {
      list.done.push_back(edit);
      list.undone.clear();  // a new edit ends what could be redone
    }
  }
  return list;
}

Edit merge_objects(Store& store, Id one, Id other, Progress& progress) {
  if (one == other) refuse(store, object_name(one) + " is itself", "name two objects");
  require_object(store, one);
  require_object(store, other);
  const Id remaining = std::min(one, other), merged = std::max(one, other);
  const std::vector<ObjectObservation> kept = store.observations_of(remaining),
                                       moved = store.observations_of(merged);
  require_separate(store, kept, remaining, merged, moved);
  std::vector<FactRow> facts = store.facts();
  std::erase_if(facts, [&](const FactRow& fact) { return fact.object != merged; });
  IdentityEdit edit{.text = fmt::format("{} is {}", object_name(merged), object_name(remaining)),
                    .groups = {{remaining, ids_of(kept)}},
                    .from = moved.front().time};
  for (const Id observation : ids_of(moved)) edit.groups[remaining].push_back(observation);
  for (const FactRow& fact : facts) {
    edit.facts.push_back(correction_of(fact));
    edit.facts.back().object = remaining;
  }
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
                       later.empty() ? "not seen from" : "first seen not before", format_time(from)),
           "loci-memory history shows when it was seen");
  const TimeNs first = later.front().time;
  const Id made = store.max_object_id() + 1;
  const IdentityEdit edit{
      .text = fmt::format("{} is {} from {} on", object_name(object), object_name(made),
                          format_time(first, store.time_zone_minutes())),
      .groups = {{object, ids_of(store.observations_of(object, {}, {}, first - 1))}, {made, ids_of(later)}},
      .from = first};
  return correct_identity(
      store, edit, [&](SceneTransaction& rows) { split_rows(store, rows, object, later, made); }, progress);
}

std::string label_of(const Store& store, Id scene, Id observation) {
  std::string label;
  for (const AnnotationRow& row : store.annotations(scene))
    if (row.type == kLabelType && row.observation == observation) label = row.value;
  return label;
}

Edit label_observation(Store& store, Id scene, int64_t number, const std::string& class_name) {
  require_utf8(class_name);
  for (const ObservationRow& row : store.observations(scene)) {
    if (row.number != number) continue;
    const std::string before = label_of(store, scene, row.id);
    const std::string what = fmt::format("observation {} of scene {}", number, scene);
    EditRun run(
        store,
        {{"text",
          class_name.empty() ? what + " has no label any more" : fmt::format("{} is a {}", what, class_name)},
         {"label", {{"scene", scene}, {"observation", row.id}, {"before", before}, {"after", class_name}}}});
    add_label(store, run.id(), scene, row.id, class_name);
    run.finish();
    return edit_of(store, run.id());
  }
  refuse(store, fmt::format("scene {} has no observation {}", scene, number), "they are counted from 0");
}

Edit say(Store& store, const std::string& about, const std::string& key, const std::string& value) {
  if (value.empty())
    remove_fact(store, about, key, "");
  else
    set_fact(store, about, key, value);
  const EditList list = edits(store);
  if (list.done.empty()) refuse(store, "nothing was changed", "the memory has this fact already");
  return list.done.back();
}

Edit name_place(Store& store, const std::string& place, const std::string& name) {
  const Snapshot snapshot(store, {});
  const std::vector<PlaceRow> meant = snapshot.places_called(place);
  if (meant.size() != 1)
    refuse(store,
           meant.empty() ? fmt::format("no place is called '{}'", place)
                         : fmt::format("'{}' may be any of {} places", place, meant.size()),
           "loci-memory room lists them");
  for (const PlaceRow& other : snapshot.places_called(name))
    if (other.id != meant[0].id && other.name == name)
      refuse(store, fmt::format("another place is called '{}'", name), "give it another name");
  if (name.starts_with("object_"))
    refuse(store, fmt::format("'{}' is the name of an object", name), "give it another name");
  return say(store, meant[0].name, kPlaceNameKey, name);
}

Edit set_joint_type(Store& store, const std::string& joint, const std::string& type) {
  const std::vector<MapRow> maps = store.maps();
  if (maps.empty()) refuse(store, "this memory was made without a map", "give --map when perceiving");
  const MapRow newest = maps.back();
  const std::string before = store.blob(newest.urdf).bytes;
  mapping::World world = mapping::parse_urdf(before, newest.name);
  std::optional<mapping::JointType> wanted;
  std::string names;
  for (const mapping::JointType known :
       {mapping::JointType::fixed, mapping::JointType::revolute, mapping::JointType::continuous,
        mapping::JointType::prismatic, mapping::JointType::floating, mapping::JointType::planar}) {
    if (type == joint_type_name(known)) wanted = known;
    names += std::string(names.empty() ? "" : ", ") + joint_type_name(known);
  }
  if (!wanted) throw Error(fmt::format("'{}' is no type of a joint", type), {}, "types are " + names);
  const PartNames called = part_names(store);
  std::vector<std::string> joints;
  mapping::Joint* found = nullptr;
  for (mapping::Joint& candidate : world.joints) {
    joints.push_back(called.joint(candidate.name));
    if (candidate.name == joint || joints.back() == joint) found = &candidate;
  }
  if (found == nullptr)
    throw Error(fmt::format("the map has no joint '{}'", joint), {newest.name, 0, {}},
                did_you_mean(joint, joints));
  const std::string text = fmt::format("{} is {}, not {}", joint, type, joint_type_name(found->type));
  found->type = *wanted;
  const bool needs_limits =
      *wanted == mapping::JointType::revolute || *wanted == mapping::JointType::prismatic;
  if (needs_limits && !found->limits) found->limits = mapping::JointLimits{};
  const Id corrected = add_corrected_map(store, newest, urdf_text(world));
  EditRun run(store, {{"text", text}, {"map", {{"before", newest.id}, {"after", corrected}}}});
  run.finish();
  return edit_of(store, run.id());
}

Edit name_part(Store& store, const std::string& part, const std::string& name) {
  if (!name.empty()) require_part_name(name);
  const std::vector<Named> all = all_named(store);
  const auto meant =
      std::find_if(all.begin(), all.end(), [&](const Named& named) { return named.is_called(part); });
  if (meant == all.end()) {
    std::vector<std::string> known;
    for (const Named& named : all) known.push_back(named.now);
    refuse(store, fmt::format("neither place, link nor joint is called '{}'", part),
           did_you_mean(part, known));
  }
  for (const Named& other : all)
    if (&other != &*meant && other.is_called(name))
      refuse(store, fmt::format("another {} is called '{}'", other.of, name), "give it another name");
  if (meant->of == std::string("place")) return name_place(store, meant->in_map, name);
  const std::string after = name == meant->in_map ? "" : name;
  const std::string before = meant->now == meant->in_map ? "" : meant->now;
  if (after == before)
    refuse(store, fmt::format("the {} is called {} already", meant->of, meant->now), "give it another name");
  const std::string text = after.empty() ? fmt::format("{} is called so again", meant->in_map)
                                         : fmt::format("{} is called {}", meant->in_map, after);
  EditRun run(store,
              {{"text", text},
               {"part", {{"of", meant->of}, {"name", meant->in_map}, {"before", before}, {"after", after}}}});
  run.finish();
  return edit_of(store, run.id());
}

Edit undo(Store& store, Progress& progress) {
  EditList list = edits(store);
  if (list.done.empty())
    refuse(store, "there is nothing to undo", "loci-memory edit list shows what was done");
  const Edit last = list.done.back();
  list.done.pop_back();
  return toggle(store, last, "undoes", list.done, progress);
}

Edit redo(Store& store, Progress& progress) {
  EditList list = edits(store);
  if (list.undone.empty())
    refuse(store, "there is nothing to redo", "loci-memory edit list shows what was undone");
  list.done.push_back(list.undone.back());
  return toggle(store, list.undone.back(), "redoes", list.done, progress);
}

}  // namespace loci::memory
