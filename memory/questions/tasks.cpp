#include "memory/questions/tasks.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "memory/questions/habits.h"
#include "memory/questions/occasions.h"
#include "memory/questions/people_time.h"
#include "memory/questions/snapshot.h"
#include "memory/questions/words.h"

namespace loci::memory {
namespace {

constexpr std::array<const char*, 4> kKinds = {"bring", "stow", "set", "clean"};

/// Below this it is more likely somewhere else than where it is believed to be.
constexpr double kLikely = 0.5;

class TaskPlanner {
 public:
  TaskPlanner(const Store& store, const TaskQuestion& question)
      : store_(store), question_(question), snapshot_(store, question.as_of) {
    answer_.kind = question.kind;
  }

  TaskAnswer plan() {
    switch (question_.kind) {
      case TaskQuestion::Kind::bring:
        bring();
        break;
      case TaskQuestion::Kind::stow:
        stow();
        break;
      case TaskQuestion::Kind::set:
        set();
        break;
      case TaskQuestion::Kind::clean:
        clean();
        break;
    }
    return std::move(answer_);
  }

 private:
  ObjectState state(Id object) const { return snapshot_.state(*snapshot_.belief(object)); }

  /// Objects that can be taken somewhere; those that are not where they were are missing.
  std::vector<ObjectState> find(const std::string& subject) {
    std::vector<ObjectState> there;
    for (const Id object : snapshot_.find_objects(subject)) {
      ObjectState found = state(object);
      const std::string name = object_text(found.object);
      if (found.status == "gone") {
        answer_.missing.push_back(fmt::format("where {} is: it has gone from {}", name,
                                              found.place ? found.place->name : "where it was"));
        continue;
      }
      if (found.probability < kLikely)
        answer_.missing.push_back(fmt::format("certainty about {}: it is only {:.0f} % sure to be {}", name,
                                              100 * found.probability,
                                              found.place ? found.place->name : "there"));
      there.push_back(std::move(found));
    }
    return there;
  }

  void bring() {
    answer_.asked = "bring " + question_.subject;
    for (ObjectState& found : find(question_.subject)) answer_.items.push_back({.object = std::move(found)});
    if (answer_.items.size() > 1)
      answer_.notes.push_back(fmt::format("'{}' may be any of {} objects; the first is the most probable",
                                          question_.subject, answer_.items.size()));
  }

  /// Where it was seen most, other than where it is if `elsewhere`.
  std::optional<TaskTarget> usual_target(const ObjectState& object, bool elsewhere) const {
    const UsualAnswer usual =
        ask(store_, UsualQuestion{.subject = object.object.name, .as_of = question_.as_of});
    size_t all = 0;
    for (const UsualPlace& place : usual.objects.at(0).places) all += place.sightings;
    for (const UsualPlace& place : usual.objects.at(0).places) {
      if (elsewhere && object.place && place.place.id == object.place->id) continue;
      return TaskTarget{place.place, place.share,
                        fmt::format("seen there in {} of {} scenes", place.sightings, all)};
    }
    return std::nullopt;
  }

  void add_with_usual_target(ObjectState object, bool elsewhere) {
    TaskItem item{.object = std::move(object)};
    item.target = usual_target(item.object, elsewhere);
    if (!item.target)
      answer_.missing.push_back(
          fmt::format("where {} belongs: it was seen at no other place", object_text(item.object.object)));
    else
      item.done = item.object.place && item.object.place->id == item.target->place.id;
    answer_.items.push_back(std::move(item));
  }

  void add_with_target(ObjectState object, const PlaceRow& place) {
    TaskItem item{.object = std::move(object)};
    item.target = TaskTarget{{place.id, place.name, place.container}, 1, "asked for"};
    item.done = item.object.place && item.object.place->id == place.id;
    answer_.items.push_back(std::move(item));
  }

  /// The place that was asked for. An unknown one is missing; of several the first is taken.
  std::optional<PlaceRow> target() {
    try {
      const std::vector<PlaceRow> places = snapshot_.find_places(question_.place);
      if (places.size() > 1)
        answer_.notes.push_back(fmt::format("'{}' may be any of {} places; {} is taken", question_.place,
                                            places.size(), places[0].name));
      return places[0];
    } catch (const UnknownName& error) {
      answer_.missing.push_back(fmt::format("the target: {} ({})", error.message(), error.hint()));
      return std::nullopt;
    }
  }

  void stow() {
    answer_.asked = "stow " + question_.subject;
    std::optional<PlaceRow> place;
    if (!question_.place.empty()) {
      answer_.asked += " to " + question_.place;
      place = target();
    }
    std::vector<ObjectState> objects;
    try {
      objects = find(question_.subject);
    } catch (const UnknownName& error) {
      if (question_.place.empty()) throw;
      answer_.missing.push_back(fmt::format("the objects: {} ({})", error.message(), error.hint()));
    }
    for (ObjectState& object : objects) {
      if (place)
        add_with_target(std::move(object), *place);
      else if (question_.place.empty())
        add_with_usual_target(std::move(object), true);
      else
        answer_.items.push_back({.object = std::move(object)});
    }
  }

  void set() {
    answer_.asked = "set " + question_.place;
    if (!question_.occasion.empty()) answer_.asked += " for " + question_.occasion;
    const std::optional<PlaceRow> place = target();
    if (!place) return;
    for (const Id object : seen_then(*place)) {
      ObjectState found = state(object);
      if (found.status == "gone")
        answer_.missing.push_back(fmt::format("{}: it has gone from {}", object_text(found.object),
                                              found.place ? found.place->name : "where it was"));
      else
        add_with_target(std::move(found), *place);
    }
    if (answer_.items.empty() && answer_.missing.empty())
      answer_.missing.push_back(
          fmt::format("what is needed: nothing was seen {} {}{}", place->container ? "in" : "on", place->name,
                      question_.occasion.empty() ? "" : " at the time of " + question_.occasion));
  }

  /// What was seen on a place at the hours of the occasion.
  std::vector<Id> seen_then(const PlaceRow& place) {
    const Occasion* occasion = occasion_called(question_.occasion);
    const bool known = occasion != nullptr;
    answer_.notes.push_back(known ? fmt::format("needed is what was seen there between {}:00 and {}:59",
                                                occasion->first_hour, occasion->last_hour)
                                  : "needed is what was seen there at any hour");
    std::vector<Id> found;
    for (const BeliefRow& belief : snapshot_.beliefs())
      for (const ObjectObservation& sighting : store_.observations_of(belief.object, question_.as_of)) {
        const int hour = local_hour(sighting.time, store_.time_zone_minutes());
        const bool then = !known || occasion->covers(hour);
        if (sighting.observation.place != place.id || !then) continue;
        found.push_back(belief.object);
        break;
      }
    return found;
  }

  void clean() {
    const bool everywhere = question_.place.empty();
    answer_.asked = everywhere ? "clean" : "clean " + question_.place;
    std::vector<Id> places;
    if (!everywhere)
      for (const PlaceRow& place : snapshot_.find_places(question_.place)) places.push_back(place.id);
    size_t in_place = 0;
    for (const BeliefRow& belief : snapshot_.beliefs()) {
      if (belief.status == ObjectStatus::gone || !belief.place) continue;
      if (!everywhere && std::find(places.begin(), places.end(), *belief.place) == places.end()) continue;
      ObjectState object = state(belief.object);
      const auto target = usual_target(object, false);
      // Of the whole room only what is not where it usually is has to move.
      if (everywhere && target && target->place.id == *belief.place)
        ++in_place;
      else
        add_with_usual_target(std::move(object), !everywhere);
    }
    if (in_place > 0) answer_.notes.push_back(fmt::format("{} objects are where they usually are", in_place));
    if (answer_.items.empty()) answer_.notes.emplace_back("nothing has to be moved");
  }

  const Store& store_;
  const TaskQuestion& question_;
  Snapshot snapshot_;
  TaskAnswer answer_;
};

}  // namespace

TaskAnswer ask(const Store& store, const TaskQuestion& question) {
  return TaskPlanner(store, question).plan();
}

std::string task_name(TaskQuestion::Kind kind) {
  return kKinds.at(static_cast<size_t>(kind));
}

TaskQuestion::Kind task_kind(const std::string& name) {
  const auto* found = std::find(kKinds.begin(), kKinds.end(), name);
  if (found == kKinds.end())
    throw Error(fmt::format("'{}' is no task", name), {}, "tasks: bring, stow, set, clean");
  return static_cast<TaskQuestion::Kind>(found - kKinds.begin());
}

}  // namespace loci::memory
