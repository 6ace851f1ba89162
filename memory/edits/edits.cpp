#include "memory/edits/edits.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "mapping/base/json.h"
#include "mapping/base/text.h"
#include "memory/edits/edit_runs.h"
#include "memory/questions/facts.h"
#include "memory/questions/place_names.h"
#include "memory/questions/snapshot.h"
#include "memory/store/edit_rows.h"

namespace loci::memory {
namespace {

bool is_edit(const RunRow& run) {
  return run.program.starts_with(kEditProgram) || run.program.starts_with("loci-memory fact ");
}

std::string text_of(const Store& store, const RunRow& run, const Json& configuration) {
  if (configuration.contains("text")) return configuration["text"].get<std::string>();
  for (const FactRow& fact : EditRows(store).facts_of(run.id))  // of `fact set` and `fact remove`
    if (fact.object)
      return fmt::format("{}: {}{}", object_name(*fact.object), fact.key,
                         fact.value ? " is " + *fact.value : " is taken back");
    else
      for (const PlaceRow& place : store.places())
        if (place.id == fact.place)
          return fmt::format("{}: {}{}", place.name, fact.key,
                             fact.value ? " is " + *fact.value : " is taken back");
  return run.program;
}

[[noreturn]] void refuse(const Store& store, const std::string& what, const std::string& hint) {
  throw Error(what, {store.path().string(), 0, {}}, hint);
}

void need_object(const Store& store, Id object) {
  const auto objects = store.objects();
  if (std::none_of(objects.begin(), objects.end(), [&](const ObjectRow& row) { return row.id == object; }))
    refuse(store, fmt::format("there is no {}", object_name(object)), "loci-memory objects lists them");
}

Edit toggle(Store& store, const Edit& edit, const char* what) {
  RunRow row;
  for (const RunRow& run : store.runs())
    if (run.id == edit.run) row = run;
  const Id run = reverse_run(store, row, edit.text, {{what, edit.run}});
  store.derive();
  return {run, edit_of(store, run).known, edit.text};
}

}  // namespace

EditList edits(const Store& store) {
  EditList list;
  const auto move_to = [](std::vector<Edit>& from, std::vector<Edit>& to, const Edit& now, Id turned) {
    const auto found =
        std::find_if(from.begin(), from.end(), [&](const Edit& edit) { return edit.run == turned; });
    if (found != from.end()) from.erase(found);
    to.push_back(now);
  };
  for (const RunRow& run : store.runs()) {
    if (!is_edit(run)) continue;
    const Json configuration = parse_json(run.configuration, "run.configuration");
    const Edit edit = {run.id, run.started, text_of(store, run, configuration)};
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

Edit merge_objects(Store& store, Id one, Id other) {
  if (one == other) refuse(store, object_name(one) + " is itself", "name two objects");
  need_object(store, one);
  need_object(store, other);
  const Id kept = std::min(one, other), given_up = std::max(one, other);
  std::set<Id> scenes;
  for (const ObjectObservation& sighting : store.observations_of(kept))
    scenes.insert(sighting.association.scene);
  const std::vector<ObjectObservation> moved = store.observations_of(given_up);
  if (moved.empty())
    refuse(store, object_name(given_up) + " was never seen", "loci-memory objects lists them");
  for (const ObjectObservation& sighting : moved)
    if (scenes.contains(sighting.association.scene))
      refuse(store,
             fmt::format("{} and {} were seen together in scene {}: they are two", object_name(kept),
                         object_name(given_up), sighting.association.scene),
             "loci-memory edit split takes a mistaken sighting away first");
  const std::vector<BeliefRow> beliefs = store.belief_history(given_up);
  const std::optional<ObjectObservation> before = store.last_observation_before(kept, moved.front().time, {});
  std::vector<EventRow> events;
  for (EventRow& event : store.events())
    if (event.object == given_up) events.push_back(std::move(event));
  std::vector<FactRow> facts;
  for (FactRow& fact : store.facts())
    if (fact.object == given_up) facts.push_back(std::move(fact));

  const EditRun run(store, {{"text", fmt::format("{} is {}", object_name(given_up), object_name(kept))}});
  {
    SceneTransaction rows(store, run.id());
    for (const ObjectObservation& sighting : moved) {
      AssociationRow row = correction_of(sighting.association);
      row.object = kept;
      rows.add_association(row);
    }
    for (const BeliefRow& belief : beliefs) {
      BeliefRow row = correction_of(belief);
      row.object = kept;
      row.probability = belief.probability_then;
      rows.add_belief(row);
    }
    for (const EventRow& event : events) {
      EventRow row = correction_of(event);
      row.object = kept;
      if (event.kind == EventKind::appeared && before) {  // it was known: it has come from somewhere
        row.kind = EventKind::moved;
        row.from_place = before->observation.place;
        row.from_position = before->observation.position;
        row.since = before->time;
      }
      rows.add_event(row);
    }
    for (const FactRow& fact : facts) {
      FactRow row = correction_of(fact);
      row.object = kept;
      rows.add_fact(row);
    }
    rows.commit();
  }
  store.derive();
  return edit_of(store, run.id());
}

Edit split_object(Store& store, Id object, TimeNs from) {
  need_object(store, object);
  const std::vector<ObjectObservation> later = store.observations_of(object, {}, from);
  const std::optional<ObjectObservation> before = store.last_observation_before(object, from, {});
  if (later.empty() || !before)
    refuse(store,
           fmt::format("{} was {} {}", object_name(object),
                       later.empty() ? "not seen from" : "first seen not before", format_time(from)),
           "loci-memory history shows when it was seen");
  const TimeNs first = later.front().time;
  std::vector<BeliefRow> beliefs;
  for (BeliefRow& row : store.belief_history(object))
    if (row.clock.valid_from >= first) beliefs.push_back(std::move(row));
  const std::optional<BeliefRow> held = store.belief(object, {first, std::nullopt});
  std::vector<EventRow> events;
  for (EventRow& event : store.events({}, first))
    if (event.object == object) events.push_back(std::move(event));

  const Id made = store.max_object_id() + 1;
  const EditRun run(store,
                    {{"text", fmt::format("{} is {} from {} on", object_name(object), object_name(made),
                                          format_time(first, store.time_zone_minutes()))},
                     {"split", {{"object", object}, {"new", made}}}});
  {
    SceneTransaction rows(store, run.id());
    ObjectRow row;
    row.clock.valid_from = first;
    row.clock.source = "user";
    const Id id = rows.add_object(row);
    if (id != made)
      throw Error("another object was added meanwhile", {store.path().string(), 0, {}}, "try again");
    for (const ObjectObservation& sighting : later) {
      AssociationRow association = correction_of(sighting.association);
      association.object = id;
      if (sighting.time == first) association.explanation = Explanation::appear;
      rows.add_association(association);
    }
    // There is only a row where there was news: what was believed then goes on as that of the new object.
    if (held && (beliefs.empty() || beliefs.front().clock.valid_from > first)) {
      BeliefRow belief = *held;
      belief.object = id;
      belief.scene = later.front().association.scene;
      belief.clock = {.valid_from = first, .source = "user"};
      rows.add_belief(belief);
    }
    for (const BeliefRow& belief : beliefs) {
      BeliefRow corrected = correction_of(belief);
      corrected.object = id;
      corrected.probability = belief.probability_then;
      rows.add_belief(corrected);
    }
    bool appeared = false;
    for (const EventRow& event : events) {
      EventRow corrected = correction_of(event);
      corrected.object = id;
      if (event.clock.valid_from == first && !appeared) {  // whatever it was taken for, it came then
        corrected.kind = EventKind::appeared;
        corrected.from_place.reset();
        corrected.from_position.reset();
        appeared = true;
      }
      rows.add_event(corrected);
    }
    if (!appeared) {
      EventRow event;
      event.scene = later.front().association.scene;
      event.kind = EventKind::appeared;
      event.object = id;
      event.observation = later.front().association.observation;
      event.place = later.front().observation.place;
      event.position = later.front().observation.position;
      event.clock = {.valid_from = first, .source = "user"};
      rows.add_event(event);
    }
    rows.commit();
  }
  store.derive();
  return edit_of(store, run.id());
}

std::string label_of(const Store& store, Id scene, Id observation) {
  std::string label;
  for (const AnnotationRow& row : store.annotations(scene))  // in the order of being said
    if (row.type == kLabelType && row.observation == observation) label = row.value;
  return label;
}

Edit label_observation(Store& store, Id scene, int64_t number, const std::string& class_name) {
  require_utf8(class_name);
  for (const ObservationRow& row : store.observations(scene)) {
    if (row.number != number) continue;
    const std::string before = label_of(store, scene, row.id);
    const std::string what = fmt::format("observation {} of scene {}", number, scene);
    const EditRun run(
        store,
        {{"text",
          class_name.empty() ? what + " has no label any more" : fmt::format("{} is a {}", what, class_name)},
         {"label", {{"scene", scene}, {"observation", row.id}, {"before", before}, {"after", class_name}}}});
    add_label(store, run.id(), scene, row.id, class_name);
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
  if (list.done.empty()) refuse(store, "nothing was changed", "it was said already");
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

Edit undo(Store& store) {
  const EditList list = edits(store);
  if (list.done.empty())
    refuse(store, "there is nothing to undo", "loci-memory edit list shows what was done");
  return toggle(store, list.done.back(), "undoes");
}

Edit redo(Store& store) {
  const EditList list = edits(store);
  if (list.undone.empty())
    refuse(store, "there is nothing to redo", "loci-memory edit list shows what was undone");
  return toggle(store, list.undone.back(), "redoes");
}

}  // namespace loci::memory
