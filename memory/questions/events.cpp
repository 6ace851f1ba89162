#include "memory/questions/events.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>

#include "memory/questions/answer_format.h"
#include "memory/questions/question.h"
#include "memory/questions/snapshot.h"

namespace loci::memory {

using namespace format;

namespace {

const std::vector<std::string> kChangeKinds = {
    "appeared", "came", "gone", "hidden", "joint_changed", "left", "looks_different", "moved", "reappeared"};

bool is_at(const std::set<Id>& places, const std::optional<PlaceRef>& place) {
  return place && places.contains(place->id);
}

bool is_of_kind(const Change& change, const std::string& kind, const std::set<Id>& places) {
  const bool moved = change.kind == EventKind::moved;
  if (kind == "left")
    return change.kind == EventKind::gone ||
           (moved && is_at(places, change.from_place) && !is_at(places, change.place));
  if (kind == "came")
    return change.kind == EventKind::appeared || change.kind == EventKind::reappeared ||
           (moved && is_at(places, change.place) && !is_at(places, change.from_place));
  return kind.empty() || to_text(change.kind) == kind;
}

SceneSummary summary_of(const Snapshot& snapshot, const SceneRow& scene) {
  SceneSummary summary{.scene = snapshot.scene_ref(scene),
                       .observations = snapshot.store().observations(scene.id).size(),
                       .has_pose = scene.map_from_camera.has_value(),
                       .forgotten = was_forgotten(snapshot.store().forgotten(), scene.time),
                       .known_from = scene.known_from};
  for (const VisibilityRow& row : snapshot.store().visibility(scene.id))
    if (row.place && row.fraction.value_or(0) > 0)
      if (const auto place = snapshot.place_ref(row.place))
        summary.seen_places.emplace_back(place->name, *row.fraction);
  return summary;
}

std::string sure_text(const Change& change) {
  return change.probability < 0.995 ? fmt::format(" ({} sure)", percent(change.probability)) : "";
}

std::string change_line(const Change& change, const TimeWriter& times) {
  std::string line = fmt::format("{}  {}{}", when_text(change, times), to_text(change), sure_text(change));
  if (change.scene) line += fmt::format(" [{}]", scene_text(*change.scene));
  if (change.source != "perceive" && !change.source.empty()) line += " - says " + change.source;
  return line;
}

std::string summary_text(const SceneSummary& summary, const TimeWriter& times) {
  std::string line = fmt::format("{}  {}", times.text(summary.scene.time), scene_text(summary.scene));
  if (summary.scene.recording) line += " of " + *summary.scene.recording;
  if (summary.forgotten) return line + ": forgotten on request";
  line += ": " + counted(summary.observations, "object") + " seen";
  std::vector<std::string> places;
  for (const auto& [place, fraction] : summary.seen_places)
    places.push_back(fmt::format("{} {:.0f} %", place, 100 * fraction));
  if (!places.empty()) line += fmt::format("; looked at {}", fmt::join(places, ", "));
  if (!summary.has_pose) line += "; camera pose unknown";
  return line;
}

Json summary_json(const SceneSummary& summary) {
  Json json = scene_json(summary.scene);
  json["observations"] = summary.observations;
  json["has_pose"] = summary.has_pose;
  if (summary.forgotten) json["forgotten"] = true;
  json["looked_at"] = Json::object();
  for (const auto& [place, fraction] : summary.seen_places) json["looked_at"][place] = fraction;
  json["known_from"] = format_time(summary.known_from);
  return json;
}

}  // namespace

ChangesAnswer ask(const Store& store, const ChangesQuestion& question) {
  if (!question.kind.empty() && std::ranges::count(kChangeKinds, question.kind) == 0)
    throw Error(fmt::format("'{}' is no kind of change", question.kind), {},
                fmt::format("kinds: {}", fmt::join(kChangeKinds, ", ")));
  const Snapshot snapshot(store, question.as_of);
  ChangesAnswer answer{.from = question.from, .to = question.to};
  std::set<Id> objects, places;
  if (!question.subject.empty())
    for (const Id object : snapshot.find_objects(question.subject)) objects.insert(object);
  if (!question.place.empty())
    for (const PlaceRow& place : snapshot.find_places(question.place)) places.insert(place.id);
  const auto is_one_of = [](const std::set<Id>& ids, std::optional<Id> id) {
    return id && ids.contains(*id);
  };
  for (const EventRow& event : store.events(question.as_of, question.from, question.to)) {
    if (!question.subject.empty() && !is_one_of(objects, event.object)) continue;
    if (!question.place.empty() && !is_one_of(places, event.place) && !is_one_of(places, event.from_place))
      continue;
    const Change change = snapshot.change(event);
    if (is_of_kind(change, question.kind, places)) answer.changes.push_back(change);
  }
  return answer;
}

std::string to_text(const ChangesAnswer& answer, const TimeWriter& times) {
  if (answer.changes.empty()) return "Nothing is known to have happened.\n";
  std::vector<std::string> lines;
  for (const Change& change : answer.changes) lines.push_back(change_line(change, times));
  return lines_text(lines);
}

Json to_json(const ChangesAnswer& answer) {
  Json json = Json::object();
  if (answer.from) json["from"] = format_time(*answer.from);
  if (answer.to) json["to"] = format_time(*answer.to);
  json["changes"] = list_json(answer.changes, change_json);
  return json;
}

ScenesAnswer ask(const Store& store, const ScenesQuestion& question) {
  const Snapshot snapshot(store, question.as_of);
  ScenesAnswer answer;
  for (const SceneRow& scene : store.scenes(question.as_of, question.from, question.to))
    answer.scenes.push_back(summary_of(snapshot, scene));
  return answer;
}

std::string to_text(const ScenesAnswer& answer, const TimeWriter& times) {
  if (answer.scenes.empty()) return "No scenes are known.\n";
  std::vector<std::string> lines;
  for (const SceneSummary& summary : answer.scenes) lines.push_back(summary_text(summary, times));
  return lines_text(lines);
}

Json to_json(const ScenesAnswer& answer) {
  return {{"scenes", list_json(answer.scenes, summary_json)}};
}

TimelineAnswer ask(const Store& store, const TimelineQuestion& question) {
  const Snapshot snapshot(store, question.as_of);
  TimelineAnswer answer;
  const std::vector<EventRow> events = store.events(question.as_of, question.from, question.to);
  size_t next = 0;
  for (const SceneRow& scene : store.scenes(question.as_of, question.from, question.to)) {
    TimelineEntry entry{.scene = summary_of(snapshot, scene)};
    for (const AssociationRow& association : store.associations(scene.id, question.as_of))
      if (association.chosen && association.object && association.observation && association.probability > 0)
        entry.seen.push_back(snapshot.object_ref(*association.object));
    for (; next < events.size() && events[next].clock.valid_from <= scene.time; ++next)
      entry.changes.push_back(snapshot.change(events[next]));
    answer.entries.push_back(std::move(entry));
  }
  return answer;
}

std::string to_text(const TimelineAnswer& answer, const TimeWriter& times) {
  if (answer.entries.empty()) return "Nothing is known.\n";
  std::vector<std::string> lines;
  for (const TimelineEntry& entry : answer.entries) {
    lines.push_back(summary_text(entry.scene, times));
    for (const Change& change : entry.changes) lines.push_back("    " + to_text(change) + sure_text(change));
  }
  return lines_text(lines);
}

Json to_json(const TimelineAnswer& answer) {
  return {{"timeline", list_json(answer.entries, [](const TimelineEntry& entry) {
             Json json = summary_json(entry.scene);
             json["seen"] = list_json(entry.seen, object_json);
             json["changes"] = list_json(entry.changes, change_json);
             return json;
           })}};
}

namespace {

std::vector<SentenceForm> changes_sentences() {
  return {
      {"when did <object> [last] (leave|reach|get to|come to|arrive on|arrive at|arrive in|go to|disappear "
       "from) "
       "<place>",
       "When did the red cup leave the table?"},
      {"what (happened|has happened) (to|with) <object>", "What happened to the cereal?"},
      {"(has|have|was|were) $someone $moved <object>"},
      {"did $someone $move <object>"},
      {"who $moved <object>"},
      {"(has|have|was|were) <object> [been] ($moved|taken away)", "Was the red cup moved this morning?"},
      {"did <object> move"},
      {"when (was|were) <object> $moved"},
      {"[is there|was there|is|was] (anything|something) (new|different) [(on|in|at) <place>]",
       "Is there anything new on the counter?"},
      {"$what (disappeared|vanished|went missing|went|left|has gone|have gone|is gone|are gone|has "
       "disappeared|"
       "have disappeared) [away] from <place>",
       "What disappeared from the table?",
       {{"kind", "left"}}},
      {"what (disappeared|vanished) (on|in|at|inside) <place>", "", {{"kind", "left"}}},
      {"what (was|has been) (taken|removed|taken away) from <place>", "", {{"kind", "left"}}},
      {"what (disappeared|has disappeared|is gone|has gone|went away|was removed|has been removed)",
       "",
       {{"kind", "left"}}},
      {"$what (appeared|has appeared|have appeared|came|arrived|was put|were put|was added) "
       "(on|onto|in|into|at|to) "
       "<place>",
       "What appeared on the table?",
       {{"kind", "came"}}},
      {"what (appeared|has appeared)", "", {{"kind", "came"}}},
      {"$what (moved|has moved|have moved|was moved) (on|in|at) <place>", "", {{"kind", "moved"}}},
      {"what (changed|has changed|happened|has happened) (on|in|at|inside) <place>",
       "What changed on the table since nine?"},
      {"(was|were|has|has been|did $someone|has $someone) <place> (opened|open|closed|close|shut)",
       "Was the drawer opened this morning?"},
      {"(did|has) $someone $open <place>"},
      {"when was <place> (opened|closed|shut)"},
      {"what (changed|has changed|happened|has happened|is new|is different|moved|has moved|did i miss|did "
       "we miss|"
       "has been moved|was moved)",
       "What changed since this morning?"},
      {"(did|has) (anything|something) (change|changed|happen|happened|move|moved)"},
      {"(was|has) (anything|something) [been] (moved|taken|removed|changed)"},
  };
}

template <class PeriodQuestion>
Answer ask_period(const Arguments& given) {
  return ask(given.store(), PeriodQuestion{.from = given.from(), .to = given.to(), .as_of = given.as_of()});
}

}  // namespace

std::vector<Question> event_questions() {
  return {
      {.name = "changes",
       .description = "What happened in a period",
       .parameters = {{.name = "object", .type = ParameterType::object, .help = "Only of these objects"},
                      {.name = "place", .type = ParameterType::place, .help = "Only at this place"},
                      {.name = "kind",
                       .help = "Only these; came and left include moves to or from the place",
                       .choices = kChangeKinds}},
       .period = true,
       .examples = {"", "--between 08:00 10:00"},
       .run = [](const Arguments& given) -> Answer {
         return ask(given.store(), ChangesQuestion{given.from(), given.to(), given.text("object"),
                                                   given.text("place"), given.as_of(), given.text("kind")});
       },
       .time = SentenceTime::period,
       .sentences = changes_sentences()},
      {.name = "timeline",
       .description = "Scenes and events in order",
       .period = true,
       .examples = {"", "--from 09:00 --json"},
       .run = ask_period<TimelineQuestion>,
       .time = SentenceTime::period,
       .sentences = {{"what (did|have) (you|we|robot) (see|seen|notice|noticed|do|done|experience)",
                      "What did you see between eight and nine?"},
                     {"(tell me about|how was) (your|our|my) day"},
                     {"[show [me]] timeline"}}},
      {.name = "scenes",
       .group = QuestionGroup::inspect,
       .description = "The scenes",
       .period = true,
       .examples = {"", "--from 09:00 --json"},
       .run = ask_period<ScenesQuestion>,
       .time = SentenceTime::period,
       .sentences = {{"(when|where) did you look", "When did you look?"}}},
  };
}

}  // namespace loci::memory
