#include <algorithm>
#include <limits>
#include <set>

#include "memory/questions/answers.h"
#include "memory/questions/snapshot.h"

namespace loci::memory {
namespace {

/// Sightings closer than this and on the same place are one stay.
constexpr double kSameSpot_m = 0.08;

std::vector<Stay> stays_of(const Snapshot& snapshot, Id object) {
  std::vector<Stay> stays;
  for (const ObjectObservation& sighting : snapshot.store().observations_of(object, snapshot.as_of())) {
    const ObservationRow& seen = sighting.observation;
    const auto place = snapshot.place_ref(seen.place);
    bool same = !stays.empty() && stays.back().place.has_value() == place.has_value() &&
                (!place || stays.back().place->id == place->id);
    if (same && seen.position && stays.back().position)
      same = (*seen.position - *stays.back().position).norm() <= kSameSpot_m;
    if (!same) stays.push_back({.place = place, .position = seen.position});
    Stay& stay = stays.back();
    if (same && seen.position && stay.position) {
      const auto count = static_cast<double>(stay.scenes.size());
      stay.position = (*stay.position * count + *seen.position) / (count + 1);
    }
    if (const auto ref = snapshot.scene_ref(sighting.association.scene)) stay.scenes.push_back(*ref);
    stay.probability = std::min(stay.probability, sighting.association.probability);
  }
  return stays;
}

Verdict verdict_of(const std::vector<PlaceContents>& places) {
  const auto believed = [](const ObjectState& state) { return state.probability >= 0.5; };
  if (std::any_of(places.begin(), places.end(), [&](const PlaceContents& contents) {
        return std::any_of(contents.there.begin(), contents.there.end(), believed);
      }))
    return Verdict::yes;
  const bool looked = std::all_of(places.begin(), places.end(), [](const PlaceContents& contents) {
    return contents.there.empty() && contents.fraction.value_or(0) >= kEnoughSeen;
  });
  return looked ? Verdict::no : Verdict::not_observed;
}

bool more_probable(const ObjectState& a, const ObjectState& b) {
  return a.probability != b.probability ? a.probability > b.probability : a.object.id < b.object.id;
}

std::vector<Alternative> alternatives_of(const Store& store, const Snapshot& snapshot,
                                         const ObjectState& state, const AsOf& as_of) {
  std::vector<Alternative> alternatives;
  if (!state.last_seen) return alternatives;
  for (const ObjectObservation& sighting :
       store.alternative_observations(state.object.id, state.last_seen->time, as_of)) {
    Alternative alternative;
    alternative.probability = sighting.association.probability;
    alternative.place = snapshot.place_ref(sighting.observation.place);
    alternative.position = sighting.observation.position;
    alternative.scene = *snapshot.scene_ref(sighting.association.scene);
    for (const AssociationRow& row : store.associations(sighting.association.scene, as_of))
      if (row.chosen && row.object && row.observation == sighting.observation.id)
        alternative.taken_for = snapshot.object_ref(*row.object);
    alternatives.push_back(std::move(alternative));
  }
  return alternatives;
}

}  // namespace

WhereAnswer ask(const Store& store, const WhereQuestion& question) {
  const Snapshot snapshot(store, question.as_of);
  WhereAnswer answer{.asked = question.subject};
  for (const Id object : snapshot.find_objects(question.subject)) {
    ObjectState state = snapshot.state(*snapshot.belief(object));
    state.alternatives = alternatives_of(store, snapshot, state, question.as_of);
    answer.objects.push_back(std::move(state));
  }
  return answer;
}

HistoryAnswer ask(const Store& store, const HistoryQuestion& question) {
  const Snapshot snapshot(store, question.as_of);
  HistoryAnswer answer{.asked = question.subject};
  const std::vector<EventRow> events = store.events(question.as_of, question.from, question.to);
  for (const Id object : snapshot.find_objects(question.subject)) {
    ObjectHistory history;
    history.now = snapshot.state(*snapshot.belief(object));
    history.stays = stays_of(snapshot, object);
    std::erase_if(history.stays, [&](const Stay& stay) {
      return (question.from && stay.scenes.back().time < *question.from) ||
             (question.to && stay.scenes.front().time > *question.to);
    });
    for (const EventRow& event : events)
      if (event.object == object) history.changes.push_back(snapshot.change(event));
    answer.objects.push_back(std::move(history));
  }
  return answer;
}

ContentsAnswer ask(const Store& store, const ContentsQuestion& question) {
  const Snapshot snapshot(store, question.as_of);
  ContentsAnswer answer{.asked = question.place, .subject = question.subject};
  const std::vector<PlaceRow> places = snapshot.find_places(question.place);
  std::set<Id> meant;
  if (!question.subject.empty())
    for (const Id object : snapshot.find_objects(question.subject)) meant.insert(object);
  for (const PlaceRow& place : places) {
    PlaceContents contents{.place = {place.id, place.name, place.container}};
    for (const Id object : store.objects_at(place.id, question.as_of)) {
      const BeliefRow* row = snapshot.belief(object);
      if (row == nullptr || row->place != place.id || row->status == ObjectStatus::gone) continue;
      if (question.subject.empty() || meant.contains(object)) contents.there.push_back(snapshot.state(*row));
    }
    const bool any = question.subject.empty();
    Store::Gone gone = store.objects_gone_from(
        place.id, any ? question.max_gone : std::numeric_limits<size_t>::max(), question.as_of);
    std::erase_if(gone.objects, [&](Id object) { return !any && !meant.contains(object); });
    contents.gone_in_all = any ? gone.in_all : gone.objects.size();
    gone.objects.resize(std::min(gone.objects.size(), question.max_gone));
    for (const Id object : gone.objects) contents.gone.push_back(snapshot.state(*snapshot.belief(object)));
    for (auto* list : {&contents.there, &contents.gone}) std::sort(list->begin(), list->end(), more_probable);
    if (const std::optional<VisibilityRow> look = store.last_visibility(place.id, question.as_of)) {
      contents.last_look = snapshot.scene_ref(look->scene);
      contents.fraction = look->fraction;
    }
    answer.places.push_back(std::move(contents));
  }
  answer.verdict = verdict_of(answer.places);
  return answer;
}

ChangesAnswer ask(const Store& store, const ChangesQuestion& question) {
  const Snapshot snapshot(store, question.as_of);
  ChangesAnswer answer{.from = question.from, .to = question.to};
  std::vector<Id> objects, places;
  if (!question.subject.empty()) objects = snapshot.find_objects(question.subject);
  if (!question.place.empty())
    for (const PlaceRow& place : snapshot.find_places(question.place)) places.push_back(place.id);
  const auto contains = [](const std::vector<Id>& ids, std::optional<Id> id) {
    return id && std::find(ids.begin(), ids.end(), *id) != ids.end();
  };
  for (const EventRow& event : store.events(question.as_of, question.from, question.to)) {
    if (!question.subject.empty() && !contains(objects, event.object)) continue;
    if (!question.place.empty() && !contains(places, event.place) && !contains(places, event.from_place))
      continue;
    answer.changes.push_back(snapshot.change(event));
  }
  return answer;
}

ObjectsAnswer ask(const Store& store, const ObjectsQuestion& question) {
  const Snapshot snapshot(store, question.as_of);
  ObjectsAnswer answer;
  if (question.subject.empty())
    for (const BeliefRow& row : snapshot.beliefs()) answer.objects.push_back(snapshot.state(row));
  else
    for (const Id object : snapshot.find_objects(question.subject))
      answer.objects.push_back(snapshot.state(*snapshot.belief(object)));
  return answer;
}

ScenesAnswer ask(const Store& store, const ScenesQuestion& question) {
  const Snapshot snapshot(store, question.as_of);
  ScenesAnswer answer;
  for (const SceneRow& scene : store.scenes(question.as_of, question.from, question.to))
    answer.scenes.push_back(snapshot.summary(scene));
  return answer;
}

TimelineAnswer ask(const Store& store, const TimelineQuestion& question) {
  const Snapshot snapshot(store, question.as_of);
  TimelineAnswer answer;
  const std::vector<EventRow> events = store.events(question.as_of, question.from, question.to);
  size_t next = 0;
  for (const SceneRow& scene : store.scenes(question.as_of, question.from, question.to)) {
    TimelineEntry entry;
    entry.scene = snapshot.summary(scene);
    for (const AssociationRow& association : store.associations(scene.id, question.as_of))
      if (association.chosen && association.object && association.observation && association.probability > 0)
        entry.seen.push_back(snapshot.object_ref(*association.object));
    for (; next < events.size() && events[next].clock.valid_from <= scene.time; ++next)
      entry.changes.push_back(snapshot.change(events[next]));
    answer.entries.push_back(std::move(entry));
  }
  return answer;
}

std::string verdict_name(Verdict verdict) {
  switch (verdict) {
    case Verdict::yes:
      return "yes";
    case Verdict::no:
      return "no";
    case Verdict::not_observed:
      return "not_observed";
  }
  return {};
}

}  // namespace loci::memory
