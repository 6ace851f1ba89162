#include "memory/questions/events.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <set>
#include <tuple>

#include "memory/questions/environment_parts.h"
#include "memory/questions/question.h"
#include "memory/questions/replies/answer_fields.h"
#include "memory/questions/replies/answer_format.h"
#include "memory/questions/snapshot.h"

namespace loci::memory {

using namespace format;

namespace {

const std::vector<std::string> kChangeKinds = {
    "appeared",      "came",        "closed",          "gone",     "handled", "hidden",
    "joint_changed", "left",        "looks_different", "moved",    "new",     "opened",
    "place_handled", "place_moved", "reappeared",      "relocated"};

bool is_at(const std::set<Id>& places, const std::optional<PlaceRef>& place) {
  return place && places.contains(place->id);
}

bool is_of_kind(const Change& change, const std::string& kind, const std::set<Id>& places) {
  const bool moved = change.kind == EventKind::moved;
  const auto& came_from = change.from_place ? change.from_place : change.place;
  if (kind == "left")
    return (change.kind == EventKind::gone && (places.empty() || is_at(places, came_from))) ||
           (moved && is_at(places, change.from_place) && !is_at(places, change.place));
  if (kind == "came")
    return ((change.kind == EventKind::appeared || change.kind == EventKind::reappeared) &&
            (places.empty() || is_at(places, change.place))) ||
           (moved && is_at(places, change.place) && !is_at(places, change.from_place));
  // What was elsewhere in the room is new at a place only; what was hidden there, or was there at the first
  // look, is not.
  if (kind == "new")
    return is_of_kind(change, "came", places) && change.since &&
           (change.kind == EventKind::appeared || (!places.empty() && !is_at(places, came_from)));
  if (kind == "handled" || kind == "relocated")
    return moved || change.kind == EventKind::reappeared ||
           (change.kind == EventKind::gone && kind == "handled");
  if (kind == "place_handled")
    return change.kind == EventKind::place_moved || is_of_kind(change, "opened", places);
  if (kind == "opened" || kind == "closed")
    return change.kind == EventKind::joint_changed && is_opening(change) == (kind == "opened");
  return kind.empty() || to_text(change.kind) == kind;
}

constexpr double kHardly = 0.05;  ///< such a share is not worth a word

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

const Record<SceneSummary>& summary_record() {
  static const auto record =
      Record<SceneSummary>("SceneSummary")
          .with(&SceneSummary::scene, scene_record())
          .value("observations", &SceneSummary::observations)
          .value("has_pose", &SceneSummary::has_pose)
          .value("forgotten", [](const SceneSummary& summary) { return if_true(summary.forgotten); })
          .value("looked_at", &SceneSummary::seen_places)
          .time("known_from", &SceneSummary::known_from);
  return record;
}

bool may_be_of_joint(const std::string& kind) {
  static const std::set<std::string> kinds = {"", "opened", "closed", "joint_changed", "place_handled"};
  return kinds.contains(kind);
}

/// Only changes of objects, joints and furniture of which there are so many.
void keep_repeated(std::vector<Change>& changes, size_t min_times) {
  const auto of = [](const Change& change) {
    return std::tuple(change.object ? change.object->id : 0, change.joint,
                      change.object || !change.place ? 0 : change.place->id);
  };
  std::map<decltype(of(changes[0])), size_t> counts;
  for (const Change& change : changes) ++counts[of(change)];
  std::erase_if(changes, [&](const Change& change) { return counts[of(change)] < min_times; });
}

}  // namespace

TimeSpan bounds_of(const Change& change) {
  return {change.since.value_or(kAlways), change.time};
}

TimeSpan hull_of(const std::vector<Change>& changes) {
  TimeSpan hull = bounds_of(changes.front());
  for (const Change& change : changes)
    hull = {std::min(hull.first, bounds_of(change).first), std::max(hull.last, change.time)};
  return hull;
}

std::partial_ordering order_of(const TimeSpan& one, const TimeSpan& other) {
  if (one.last <= other.first) return std::partial_ordering::less;
  return other.last <= one.first ? std::partial_ordering::greater : std::partial_ordering::unordered;
}

double share_before(const Change& change, TimeNs time) {
  if (!change.since || *change.since >= time) return 0;
  return std::min(
      1.0, static_cast<double>(time - *change.since) / static_cast<double>(change.time - *change.since));
}

ChangesAnswer ask(const Store& store, const ChangesQuestion& question) {
  if (!question.kind.empty() && std::ranges::count(kChangeKinds, question.kind) == 0)
    throw Error(fmt::format("'{}' is no kind of change", question.kind), {},
                fmt::format("kinds: {}", fmt::join(kChangeKinds, ", ")));
  const Snapshot snapshot(store, question.as_of);
  ChangesAnswer answer{.from = question.from, .to = question.to};
  std::set<Id> objects, places;
  if (!question.subject.empty())
    for (const Id object : snapshot.find_objects(question.subject)) objects.insert(object);
  std::set<std::string> joints;  // of parts that need not be places
  if (!question.place.empty()) {
    // The map is read for joints only: that takes longer than all else.
    if (may_be_of_joint(question.kind) || snapshot.places_called(question.place).empty())
      joints = joints_called(snapshot, question.place);
    if (joints.empty() || !snapshot.places_called(question.place).empty())
      for (const PlaceRow& place : snapshot.find_places(question.place)) places.insert(place.id);
  }
  std::set<Id> others;
  if (!question.other.empty())
    for (const PlaceRow& place : snapshot.find_places(question.other)) others.insert(place.id);
  const auto is_between = [&](const Change& change) {
    const bool there = is_at(others, change.from_place) && is_at(places, change.place);
    const bool back = is_at(places, change.from_place) && is_at(others, change.place);
    return there || (back && question.kind != "came");
  };
  const auto is_one_of = [](const std::set<Id>& ids, std::optional<Id> id) {
    return id && ids.contains(*id);
  };
  const auto is_still_there = [&](const Change& change) {
    const BeliefRow* now = change.object ? snapshot.belief(change.object->id) : nullptr;
    return now != nullptr && now->status != ObjectStatus::gone &&
           (places.empty() || is_one_of(places, now->place));
  };
  // "What came at half past nine?" asks for what the look at that time showed.
  const bool of_moment = !question.from || (question.to && *question.to - *question.from <= kMinute);
  const auto seen_between = [&](std::optional<TimeNs> from, std::optional<TimeNs> to) {
    std::vector<Change> changes;
    for (const EventRow& event : store.events(question.as_of, from, to)) {
      if (!question.subject.empty() && !is_one_of(objects, event.object)) continue;
      const bool at_place = is_one_of(places, event.place) || is_one_of(places, event.from_place) ||
                            (event.joint && joints.contains(*event.joint));
      if (!question.place.empty() && !at_place) continue;
      const Change change = snapshot.change(event);
      if (!of_moment && share_before(change, *question.from) > 1 - kHardly) continue;
      if (is_of_kind(change, question.kind, places) && (question.other.empty() || is_between(change)) &&
          (question.kind != "new" || is_still_there(change)))
        changes.push_back(change);
    }
    return changes;
  };
  answer.changes = seen_between(question.from, question.to);
  if (question.min_times > 1) keep_repeated(answer.changes, question.min_times);
  if (answer.changes.empty() && question.to && !of_moment) {
    answer.perhaps = seen_between(*question.to + 1, *question.to + kDay);
    std::erase_if(answer.perhaps,
                  [&](const Change& change) { return share_before(change, *question.to) < kHardly; });
  }
  return answer;
}

std::string to_text(const ChangesAnswer& answer, const TimeWriter& times) {
  std::vector<std::string> lines;
  for (const Change& change : answer.changes) lines.push_back(change_line(change, times));
  if (answer.changes.empty()) lines.emplace_back("Nothing is known to have happened.");
  for (const Change& change : answer.perhaps) lines.push_back("perhaps  " + change_line(change, times));
  return lines_text(lines);
}

namespace {

const Record<ChangesAnswer>& changes_record() {
  static const auto record = Record<ChangesAnswer>("ChangesAnswer")
                                 .time("from", &ChangesAnswer::from)
                                 .time("to", &ChangesAnswer::to)
                                 .record("changes", &ChangesAnswer::changes, change_record())
                                 .record("perhaps", &ChangesAnswer::perhaps, change_record());
  return record;
}

}  // namespace

Json to_json(const ChangesAnswer& answer) {
  return changes_record().json(answer);
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

namespace {

const Record<ScenesAnswer>& scenes_record() {
  static const auto record =
      Record<ScenesAnswer>("ScenesAnswer").record("scenes", &ScenesAnswer::scenes, summary_record());
  return record;
}

}  // namespace

Json to_json(const ScenesAnswer& answer) {
  return scenes_record().json(answer);
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

namespace {

const Record<TimelineEntry>& entry_record() {
  static const auto record = Record<TimelineEntry>("TimelineEntry")
                                 .with(&TimelineEntry::scene, summary_record())
                                 .record("seen", &TimelineEntry::seen, object_record())
                                 .record("changes", &TimelineEntry::changes, change_record());
  return record;
}

const Record<TimelineAnswer>& timeline_record() {
  static const auto record =
      Record<TimelineAnswer>("TimelineAnswer").record("timeline", &TimelineAnswer::entries, entry_record());
  return record;
}

}  // namespace

Json to_json(const TimelineAnswer& answer) {
  return timeline_record().json(answer);
}

namespace {

/// Verbs of a kind of change, how they take its place, and what may be said beside them.
struct ChangeVerbs {
  const char *kind, *verbs, *place, *beside;
};

/// Which objects changed, how many, whether and when any did; of all of them the first, the last, the one
/// that did most often: at a place or anywhere.
std::vector<SentenceForm> sentences_of_all(const ChangeVerbs& change) {
  using enum Asks;
  const std::map<std::string, std::string> kind = {{"kind", change.kind}};
  std::vector<SentenceForm> forms;
  for (const std::string& place : {std::string(), std::string(" ") + change.place}) {
    const auto add = [&](const std::string& mood, const std::string& object, Asks asks) {
      forms.push_back(
          {fmt::format("{} {} {}{} {}", mood, change.verbs, object, place, change.beside), asks, "", kind});
    };
    for (const auto& [order, asks] :
         {std::pair("what: first", earliest), {"what: last", latest}, {"what: mostoften", most}}) {
      add(order, "which<object>", asks);
      add(order, "<object>", asks);  // "the pot or the cup"
      add(order, "[thing|everything|new]", asks);
    }
    add("howlong: ago", "<object>", ago);
    // What has left the room is a question for the objects.
    if (place.empty() && kind.at("kind") == "left") continue;
    add("what:", "which<object>", objects);
    add("what:", "[thing|everything|new]", objects);
    add("howmany:", "<object>", number);
    add("howmany:", "[thing]", number);
    add("howoften:", "thing", number);
    add("when:", "thing [last]", last_time);
    add("when: first", "thing", first_time);
    add("yes|bare:", "thing", verdict);
  }
  return forms;
}

/// Which parts were opened or closed, how many, whether and when any was; of all of them the first and the
/// last. What is open or closed at a time is a question for `opens`.
std::vector<SentenceForm> sentences_of_parts() {
  using enum Asks;
  std::vector<SentenceForm> forms;
  for (const auto& [kind, verb] : {std::pair("opened", "opened was|did|have|had|been|time"),
                                   {"opened", "open did|have|had|person"},
                                   {"closed", "close was|did|have|had|been"}}) {
    const std::map<std::string, std::string> so = {{"kind", kind}};
    const auto add = [&](const std::string& form, Asks asks) {
      forms.push_back({fmt::format(fmt::runtime(form), verb), asks, "", so});
    };
    for (const auto& [order, asks] : {std::pair("first", earliest), {"last", latest}})
      for (const char* which : {"[thing]", "which<place>"})
        add(fmt::format("what: {} {{}} {}", order, which), asks);
    add("what: mostoften {} [thing]", most);
    add("what: {} [thing]", objects);
    add("howmany: {} [thing]", number);
    add("yes|bare: thing {} [back]", verdict);
    add("when: thing {} [last]", last_time);
    add("when: first thing {}", first_time);
  }
  forms.push_back({"what: which<place> close did|have|had|been|person", objects, "", {{"kind", "closed"}}});
  forms.push_back({"what: last opened [thing]", latest, "What was opened last?", {{"kind", "opened"}}});
  forms.push_back({"howmany: opened <place>", objects, "", {{"kind", "opened"}}});
  return forms;
}

std::vector<SentenceForm> changes_sentences() {
  using enum Asks;
  const auto kind = [](const char* name) { return std::map<std::string, std::string>{{"kind", name}}; };
  const auto left = kind("left"), came = kind("came"), handled = kind("handled"), opened = kind("opened"),
             shut = kind("closed");
  std::vector<SentenceForm> forms = {
      {"when: leave|vanish|go|take|move <object> from<place> [last|away|first]", last_time, "", left},
      {"when: leave <object> <place> [last|first]", last_time, "When did the red cup leave the table?", left},
      {"when: come|move|go|put|bring|take|get <object> to<place> [last|back]", last_time,
       "When did the tea come to the table?", came},
      {"when: first come|move|go|put|bring|take|get <object> to<place> [back]", first_time, "", came},
      {"when: vanish|go|leave|take|lose|miss <object> [away|last]", last_time,
       "When did the banana disappear?", left},
      {"when: come <object> [last|back]", last_time, "", came},
      {"when: first come <object>", first_time, "", came},
      {"when: move <object> [last|away]", last_time, "When was the pot moved?", handled},
      {"when: put|bring|get|go back <object> [last]", last_time, "When was the pot put back?", handled},
      {"bare: last move <object>", last_time, "", handled},
      {"sincewhen: vanish|go|leave|take|lose|miss <object> [away|last]", last_time,
       "Since when is the plate missing?", left},
      {"sincewhen: vanish|go|leave|take|miss <object> from<place> [away]", last_time, "", left},
      {"sincewhen: open|opened <place> [leave]", last_time, "", opened},
      {"sincewhen: close <place> [leave]", last_time, "", shut},
      {"when: empty|clean <place> [last]", last_time, "When was the table cleared?", left},
      {"howlong: open <place> [leave]", duration, "How long was the drawer open?", kind("joint_changed")},
      {"howlong: close <place>", closed_for, "How long has the drawer been closed?", kind("joint_changed")},
      {"when: first move <object>", first_time, "", handled},
      {"when: open|opened <place> [last]", last_time, "When was the drawer last opened?", opened},
      {"when: move|look <place> [last]", last_time, "When was the table moved?", kind("place_handled")},
      {"bare: last opened <place>", place, "", opened},
      {"bare: last close <place>", last_time, "", shut},
      {"when: first open|opened <place>", first_time, "", opened},
      {"when: close <place> [last]", last_time, "", shut},
      {"when: first close <place>", first_time, "", shut},
      {"what|bare|order: happen into<object> [tell|last]", summary, "What happened to the cereal?"},
      {"what: happen with<object>"},
      {"what: act into<object>"},
      {"yes: empty|clean|put|stow away <object>", verdict, "", left},
      {"yes|bare: move|take <object> [away]", verdict, "Did someone move the tea?", handled},
      {"yes: leave|vanish|go|take|move <object> from<place> [away]", verdict, "", left},
      {"yes: leave <object> <place>", verdict, "", left},
      {"yes: leave|vanish|go <object> time [away]", verdict, "", left},
      {"yes: come|put|move|go|bring|take <object> to<place>", verdict, "", came},
      {"yes: come|put|move|go|bring|take from<other> <object> to<place>", verdict,
       "Did the cup go from the table to the counter?", came},
      {"when: come|put|move|go|bring|take from<other> <object> to<place> [last]", last_time, "", came},
      {"what: come|put|move|go|bring|take from<other> to<place> [thing]", objects, "", came},
      {"what: come|put|move|go|bring|take from<other> which<object> to<place>", objects, "", came},
      {"what: move|go|come between<place> and<other> [thing]", objects,
       "What moved between the table and the counter?"},
      {"what: move|go|come which<object> between<place> and<other>", objects},
      {"yes: come <object> [back]", verdict, "", came},
      {"yes|bare: opened <place>", verdict, "Was the drawer opened this morning?", opened},
      {"yes: did|have open <place>", verdict, "", opened},
      {"yes: did|have close <place>", verdict, "", shut},
      {"yes|bare: thing change|happen|move|take|new|act [away|leave|back]", verdict},
      {"yes|bare: thing come [new|back]", verdict, "", came},
      {"yes|bare: thing change|happen|move|take|new|act at<place> [away|put]", verdict,
       "Did anything change on the shelf?"},
      {"yes|bare: thing come|put at<place> [new|back]", verdict, "Did anything appear on the table?", came},
      {"yes|bare: thing vanish|go at<place> [away]", verdict, "", left},
      {"what: last happen|change [thing]", summary, "What happened last?"},
      {"when: thing change|happen [last|see]", last_time, "When did anything change last?"},
      {"when: thing change|happen at<place> [last|see]", last_time},
      {"howlong: ago thing change|happen|move", ago},
      {"howlong: ago thing change|happen|move at<place>", ago,
       "How long ago did anything change on the shelf?"},
      {"yes: been|was person at<place>", verdict, "Has anybody been at the drawer?"},
      {"yes: been|was person near<place>", verdict},
      {"yes: move|look <place> -thing", verdict, "", kind("place_handled")},
      {"yes: look into<place>", verdict, "", opened},
      {"yes|bare: thing vanish|go|take|leave|move from<place> [away]", verdict, "", left},
      {"yes|bare: thing leave <place>", verdict, "", left},
      {"yes|bare: thing come|put|bring to<place>", verdict, "", came},
      {"yes: change <place>", verdict},
      {"what: vanish|go|leave|take|move from<place> [thing|away]", objects,
       "What disappeared from the table?", left},
      {"what: leave <place> [thing]", objects, "", left},
      {"what: vanish|take at<place> [thing]", objects, "", left},
      {"what: leave|take [thing|away]", objects, "", left},
      {"what: come|put|bring back to<place> [thing]", objects, "", kind("reappeared")},
      {"what: come|put|bring back [thing]", objects, "What came back?", kind("reappeared")},
      {"what: which<object> come|put|bring back", objects, "", kind("reappeared")},
      {"what: which<object> come|put|bring back to<place>", objects, "", kind("reappeared")},
      {"what: come|put|bring to<place> [thing|new]", objects, "What appeared on the table?", came},
      {"what: move|go|take into<place> [thing]", objects, "", came},
      {"what: come [thing|new|back]", objects, "", came},
      {"what: move [thing]", objects, "What moved after noon?", kind("relocated")},
      {"what: move at<place> [thing]", objects, "", kind("relocated")},
      {"what: which<object> move|take [away]", objects, "", handled},
      {"what: which<object> come|put|bring|add to<place>", objects, "", came},
      {"what: last come|put|bring which<object> [to|back]", latest, "Which cup came last?", came},
      {"what: last leave which<object> <place>", latest, "", left},
      {"what: last leave <place> [thing]", latest, "", left},
      {"what: last leave <object>", latest, "", left},
      {"what: first leave which<object> <place>", earliest, "Which cup left the table first?", left},
      {"what: first leave <place> [thing]", earliest, "", left},
      {"what: first leave <object>", earliest, "Which left first, the plate or the bowl?", left},
      {"what: first leave <place> <object>", earliest, "", left},
      {"what: first leave|vanish|go|take|move from<place> <object> [away]", earliest, "", left},
      {"what: first come|put|bring to<place> <object>", earliest, "", came},
      {"what: first come <place> <object>", earliest, "", came},
      {"what: first at<place> <object>", earliest, "Which was on the table first, the cup or the bowl?",
       came},
      {"what: last leave <place> <object>", latest, "", left},
      {"what: last leave|vanish|go|take|move from<place> <object> [away]", latest, "", left},
      {"what: last come|put|bring to<place> <object>", latest, "", came},
      {"what: last come <place> <object>", latest, "", came},
      {"what: mostoften which<object> move [away]", most, "Which object was moved most often?",
       kind("relocated")},
      {"what: mostoften which<object> take [away]", most, "", handled},
      {"what: mostoften move [thing]", most, "", kind("relocated")},
      {"what: mostoften take [thing]", most, "", handled},
      {"what: mostoften which<place> open|opened|move", most, "Which drawer was opened most often?", opened},
      {"what: which<object> move|go|take into<place>", objects, "", came},
      {"what: which<object> come <place>", objects, "", came},
      {"what: which<object> leave <place>", objects, "", left},
      {"what: which<object> vanish|go|leave|take|move from<place> [away]", objects, "", left},
      {"what: which<object> leave|take [away]", objects, "", left},
      {"what: come <place> [thing]", objects, "", came},
      {"when: come <object> <place> [last]", last_time, "", came},
      {"yes: come <object> <place>", verdict, "", came},
      {"what: new at<place> [thing]", objects, "What is new on the table?", kind("new")},
      {"what: new [thing|everything]", objects, "What is new today?", kind("new")},
      {"yes|bare: thing new at<place>", verdict, "", came},
      {"yes|bare: thing new", verdict, "", kind("new")},
      {"what: change|happen [thing|new|miss|everything]", objects, "What changed since this morning?"},
      {"what: change|happen at<place> [thing|new|everything]", objects,
       "What changed on the table since nine?"},
      {"what: miss person did|have", objects},
      {"bare|order: change [show|list|name|everything]", objects},
      {"bare|order: change at<place> [show|list|name|everything]", objects},
      {"bare|order|what: change|move <object> [show|list|name|everything|every|location]", summary, "",
       handled},
      {"howoften: move|change <object>", number, "How often did the milk move?", kind("relocated")},
      {"howoften: take <object>", number, "", handled},
      {"howoften: leave <object> <place>", number, "", left},
      {"howoften: come|go|move|put <object> to<place>", number, "", came},
      {"howoften: come|put|move|go|bring|take from<other> <object> to<place>", number, "", came},
      {"howoften: open|opened <place>", number, "How often was the drawer opened?", opened},
      {"howoften: move <place>", number, "", kind("place_handled")},
      {"howoften: act open|opened person <place>", number, "", opened},
      {"howoften: close <place>", number, "", shut},
      {"what: which<place> opened last", place, "Which drawer was opened last?", opened},
      {"what: which<place> open last was|did|have", place, "", opened},
      {"what: opened last <place>", place, "", opened},
      {"what: which<place> opened|move|look", objects, "", opened},
      {"what: which<place> open did|have|person", objects, "", opened},
      {"who: move|take|put|leave|get|bring|lose <object> [last|away]", agent, "Who moved the pot?", handled},
      {"who: move|take|put|leave|get|bring <object> to<place> [last]", agent, "", handled},
      {"who: move|take|get <object> from<place> [last|away]", agent, "", handled},
      {"who: move|take|put|go|bring from<other> <object> to<place> [last]", agent, "", came},
      {"who: open|opened|close <place> [last]", agent, "", opened},
      {"why: move|take <object> [person|away] -know -think -sure", motive, "Why was the pot moved?"},
      {"why: move|take|put|leave|bring person <object> [away|back] -know -think -sure", motive},
      {"why: move|take|put|leave|bring person <object> to<place> [back] -know -think -sure", motive, "",
       came},
      {"why: open|opened|close did|have|would|person <place> -know -think -sure", motive, "", opened},
      {"who: empty|clean <place> [last]", agent, "Who cleared the table?", left},
      {"who: move <place> [last]", agent, "Who moved the table?", kind("place_handled")},
      {"howmany: move [thing]", number, "How many objects were moved?", kind("relocated")},
      {"howmany: leave <place> [thing]", number, "", left},
  };
  for (const ChangeVerbs& change : {ChangeVerbs{"came", "come|put|bring", "to<place>", "[back|every|to]"},
                                    {"left", "vanish|go|take", "from<place>", "[away|every]"},
                                    {"relocated", "move", "at<place>", "[away|back|every]"}})
    for (SentenceForm& form : sentences_of_all(change)) forms.push_back(std::move(form));
  for (SentenceForm& form : sentences_of_parts()) forms.push_back(std::move(form));
  return forms;
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
       .parameters =
           {{.name = "object", .type = ParameterType::object, .help = "Only of these objects"},
            {.name = "place", .type = ParameterType::place, .help = "Only at this place"},
            {.name = "kind",
             .help =
                 "Only these; came and left include moves to or from the place, handled: "
                 "moved, gone or reappeared; relocated: moved or reappeared; new: came and is still there; "
                 "place_handled: opened, or furniture that was moved",
             .choices = kChangeKinds},
            {.name = "other",
             .type = ParameterType::place,
             .help = "Only moves between --place and this place; with --kind came from there"},
            {.name = "times",
             .type = ParameterType::number,
             .help = "Only of what changed so often",
             .min = 1}},
       .period = true,
       .examples = {"", "--between 08:00 10:00"},
       .answer = format::schema_by<changes_record>,
       .run = [](const Arguments& given) -> Answer {
         return ask(given.store(),
                    ChangesQuestion{given.from(), given.to(), given.text("object"), given.text("place"),
                                    given.as_of(), given.text("kind"), given.text("other"),
                                    static_cast<size_t>(given.number("times").value_or(1))});
       },
       .time = SentenceTime::period,
       .sentences = changes_sentences(),
       .of_moment = false},
      {.name = "timeline",
       .description = "Scenes and events in order",
       .period = true,
       .examples = {"", "--from 09:00 --json"},
       .answer = format::schema_by<timeline_record>,
       .run = ask_period<TimelineQuestion>,
       .time = SentenceTime::period,
       .sentences = {{"what: see person [thing|everything]", Asks::summary,
                      "What did you see between eight and nine?"},
                     {"what: act person -may"},
                     {"bare|order|what: timeline [show|give]"}},
       .of_moment = false},
      {.name = "scenes",
       .group = QuestionGroup::inspect,
       .description = "The scenes",
       .period = true,
       .examples = {"", "--from 09:00 --json"},
       .answer = format::schema_by<scenes_record>,
       .run = ask_period<ScenesQuestion>,
       .time = SentenceTime::period,
       .sentences = {{"when|where: look person [last]", Asks::summary, "When did you look?"},
                     {"howmany: scene|look [person|there|room]", Asks::number},
                     {"howoften: look person", Asks::number}},
       .of_moment = false},
  };
}

}  // namespace loci::memory
