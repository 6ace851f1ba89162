#include "memory/questions/routines/tasks.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "memory/questions/question.h"
#include "memory/questions/replies/answer_fields.h"
#include "memory/questions/replies/answer_format.h"
#include "memory/questions/routines/routines.h"
#include "memory/questions/snapshot.h"

namespace loci::memory {

using namespace format;

namespace {

const std::vector<std::string> kTasks = {"bring", "stow", "set",
                                         "clean"};  // in the order of TaskQuestion::Kind

/// Below this probability it is more likely somewhere else than where it is believed to be.
constexpr double kMinLikely = 0.5;

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
  /// Objects that can be taken somewhere; gone and uncertain ones are reported as missing.
  std::vector<ObjectBelief> find(const std::string& subject) {
    std::vector<ObjectBelief> there;
    for (const Id object : snapshot_.find_objects(subject)) {
      ObjectBelief found = snapshot_.object_belief(object);
      const std::string name = to_text(found.object);
      if (found.status == ObjectStatus::gone) {
        answer_.missing.push_back(fmt::format("where {} is: it has gone from {}", name,
                                              found.place ? found.place->name : "where it was"));
        continue;
      }
      if (found.probability < kMinLikely)
        answer_.missing.push_back(fmt::format("certainty about {}: it is only {:.0f} % sure to be {}", name,
                                              100 * found.probability,
                                              found.place ? found.place->name : "there"));
      there.push_back(std::move(found));
    }
    return there;
  }

  void bring() {
    answer_.asked = "bring " + question_.subject;
    for (ObjectBelief& found : find(question_.subject)) answer_.items.push_back({.object = std::move(found)});
    if (answer_.items.size() > 1)
      answer_.notes.push_back(fmt::format("'{}' may be any of {} objects; the first is the most probable",
                                          question_.subject, answer_.items.size()));
  }

  /// Where it was seen most, other than where it is if `elsewhere`.
  std::optional<TaskTarget> usual_target(const ObjectBelief& object, bool elsewhere) const {
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

  void add_with_usual_target(ObjectBelief object, bool elsewhere) {
    TaskItem item{.object = std::move(object)};
    item.target = usual_target(item.object, elsewhere);
    if (!item.target)
      answer_.missing.push_back(
          fmt::format("where {} belongs: it was seen at no other place", to_text(item.object.object)));
    else
      item.done = item.object.place && item.object.place->id == item.target->place.id;
    answer_.items.push_back(std::move(item));
  }

  void add_with_target(ObjectBelief object, const PlaceRow& place) {
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
    std::vector<ObjectBelief> objects;
    try {
      objects = find(question_.subject);
    } catch (const UnknownName& error) {
      if (question_.place.empty()) throw;
      answer_.missing.push_back(fmt::format("the objects: {} ({})", error.message(), error.hint()));
    }
    for (ObjectBelief& object : objects) {
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
      ObjectBelief found = snapshot_.object_belief(object);
      if (found.status == ObjectStatus::gone)
        answer_.missing.push_back(fmt::format("{}: it has gone from {}", to_text(found.object),
                                              found.place ? found.place->name : "where it was"));
      else
        add_with_target(std::move(found), *place);
    }
    if (answer_.items.empty() && answer_.missing.empty())
      answer_.missing.push_back(
          fmt::format("what is needed: nothing was seen {} {}{}", place->container ? "in" : "on", place->name,
                      question_.occasion.empty() ? "" : " at the time of " + question_.occasion));
  }

  /// Objects seen on a place at the hours of the occasion.
  std::vector<Id> seen_then(const PlaceRow& place) {
    const Occasion* occasion = find_occasion(question_.occasion);
    const bool known = occasion != nullptr;
    answer_.notes.push_back(known ? fmt::format("needed is what was seen there between {}:00 and {}:59",
                                                occasion->first_hour, occasion->last_hour)
                                  : "needed is what was seen there at any hour");
    std::vector<Id> found;
    for (const BeliefRow& belief : snapshot_.beliefs())
      for (const ObjectObservation& sighting : store_.observations_of(belief.object, question_.as_of)) {
        const int hour = local_hour(sighting.time, store_.time_zone());
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
      ObjectBelief object = snapshot_.object_belief(belief);
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

std::string item_text(const TaskItem& item, const TimeWriter& times) {
  std::string text = belief_text(item.object, times);
  if (!item.target) return text;
  return text + (item.done
                     ? fmt::format(" It is where it is to be ({}).", item.target->reason)
                     : fmt::format(" To go {} ({}).", place_text(item.target->place), item.target->reason));
}

const Record<TaskTarget>& target_record() {
  static const auto record = Record<TaskTarget>("TaskTarget")
                                 .value("place", &TaskTarget::place)
                                 .value("probability", &TaskTarget::probability)
                                 .value("reason", &TaskTarget::reason);
  return record;
}

const Record<TaskItem>& item_record() {
  static const auto record = Record<TaskItem>("TaskItem")
                                 .with(&TaskItem::object, belief_record())
                                 .record("target", &TaskItem::target, target_record())
                                 .value("done", &TaskItem::done);
  return record;
}

const Record<TaskAnswer>& task_record() {
  static const auto record =
      Record<TaskAnswer>("TaskAnswer")
          .value("task", [](const TaskAnswer& answer) { return kTasks.at(static_cast<size_t>(answer.kind)); })
          .value("asked", &TaskAnswer::asked)
          .record("objects", &TaskAnswer::items, item_record())
          .value("missing", &TaskAnswer::missing)
          .value("notes", &TaskAnswer::notes);
  return record;
}

}  // namespace

TaskAnswer ask(const Store& store, const TaskQuestion& question) {
  return TaskPlanner(store, question).plan();
}

std::string to_text(const TaskAnswer& answer, const TimeWriter& times) {
  std::vector<std::string> lines;
  for (const TaskItem& item : answer.items) lines.push_back(item_text(item, times));
  if (answer.items.empty()) lines.emplace_back("No object is concerned.");
  for (const std::string& missing : answer.missing) lines.push_back("Missing: " + missing + ".");
  for (const std::string& note : answer.notes) lines.push_back("Note: " + note + ".");
  return lines_text(lines);
}

Json to_json(const TaskAnswer& answer) {
  return task_record().json(answer);
}

namespace {

/// "bring X", "stow X", "set PLACE", "clean [PLACE]".
void read_task(std::vector<std::string> words, Query& query) {
  query.arguments["task"] = words[0];
  if (words.size() == 1) return;
  const bool of_objects = words[0] == "bring" || words[0] == "stow";
  query.arguments[of_objects ? "object" : "place"] =
      fmt::format("{}", fmt::join(words.begin() + 1, words.end(), " "));
}

Answer ask_task(const Arguments& given) {
  const auto kind =
      static_cast<TaskQuestion::Kind>(std::ranges::find(kTasks, given.text("task")) - kTasks.begin());
  const bool stow = kind == TaskQuestion::Kind::stow;
  const bool of_objects = stow || kind == TaskQuestion::Kind::bring;
  const auto takes = [&](const char* name, bool does) {
    if (!does && !given.text(name).empty())
      throw Error(fmt::format("'{}' does not take {}", given.text("task"), name));
  };
  takes("place", kind != TaskQuestion::Kind::bring);
  takes("destination", stow);
  takes("occasion", kind == TaskQuestion::Kind::set);
  const std::string destination = given.text(given.text("destination").empty() ? "place" : "destination");
  // What follows the task without a name is what it is about.
  const std::string about = given.text(of_objects || given.text("place").empty() ? "object" : "place");
  if (about.empty() && kind != TaskQuestion::Kind::clean)
    throw Error(fmt::format("'{}' needs {}", given.text("task"), of_objects ? "an object" : "a place"));
  return ask(given.store(), TaskQuestion{.kind = kind,
                                         .subject = of_objects ? about : "",
                                         .place = stow         ? destination
                                                  : of_objects ? ""
                                                               : about,
                                         .occasion = given.text("occasion"),
                                         .as_of = given.as_of()});
}

std::vector<SentenceForm> task_sentences() {
  const auto task = [](const char* kind) { return std::map<std::string, std::string>{{"task", kind}}; };
  const auto at_table = std::map<std::string, std::string>{{"task", "set"}, {"place", "table"}};
  using enum Asks;
  return {
      {"order: set|lay|prepare <place> for<occasion> -says", summary, "Set the table for breakfast.",
       task("set")},
      {"order: prepare|lay|set for<occasion> -says", summary, "", at_table},
      {"order: prepare <occasion> -says", summary, "", at_table},
      {"order: lay|set <place> -says", summary, "", task("set")},
      {"order: clean|empty room|everything -says", summary, "Clean up the kitchen.", task("clean")},
      {"order: clean|empty -says", summary, "", task("clean")},
      {"order: clean|empty|wipe <place> -says", summary, "Clear the table.", task("clean")},
      {"order: clean|empty|wipe from<place> -says", summary, "", task("clean")},
      {"order: stow|put|clean|keep|pack|empty away <object> into<destination> -says", summary, "",
       task("stow")},
      {"order: stow|put|clean|keep|pack|empty away <object> [everything] -says", summary,
       "Stow away the items in the shopping basket.", task("stow")},
      {"order: put|bring|come back <object> -says", summary, "", task("stow")},
      {"order: put|place|stow|keep|move|lay|set|take|bring|carry <object> to<destination> [everything|back] "
       "-says",
       summary, "Put all perishable items in the fridge.", task("stow")},
      {"order: bring|fetch|get|give|hand|pass <object> -says", summary, "Bring me my tea cup.",
       task("bring")},
      {"order: bring|fetch|get|give|hand|pass|take <object> from<place> -says",
       summary,
       "",
       {{"task", "bring"}, {"object", "{object} on {place}"}, {"place", ""}}},
      {"order: want <object> says", summary, "", task("bring")},
      {"order: like<object> says may", summary, "", task("bring")},
  };
}

}  // namespace

std::vector<Question> task_questions() {
  Parameter object = object_parameter(), place = place_parameter();
  object.required = place.required = false;
  return {
      {.name = "task",
       .description = "What a task needs: the objects, where they are, where they go, and what is missing",
       .parameters = {{.name = "task",
                       .help = "bring OBJECT, stow OBJECT, set PLACE, or clean [PLACE]",
                       .positional = true,
                       .required = true,
                       .choices = kTasks},
                      object,
                      place,
                      {.name = "destination",
                       .type = ParameterType::place,
                       .help = "stow: where to put it",
                       .default_text = "where it usually is"},
                      {.name = "occasion", .help = "set: for example breakfast", .default_text = "any"}},
       .words_help = "bring|stow OBJECT, set PLACE, clean [PLACE]",
       .read_words = read_task,
       .examples = {"set table --occasion breakfast", "stow red --destination drawer_1 --json"},
       .answer = format::schema_by<task_record>,
       .run = ask_task,
       .time = SentenceTime::none,
       .sentences = task_sentences()},
  };
}

}  // namespace loci::memory
