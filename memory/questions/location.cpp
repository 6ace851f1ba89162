#include "memory/questions/location.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "memory/questions/question.h"
#include "memory/questions/replies/answer_fields.h"
#include "memory/questions/replies/answer_format.h"
#include "memory/questions/snapshot.h"

namespace loci::memory {

using namespace format;

namespace {

/// Observations closer than this and on the same place are one stay.
constexpr double kSameSpot_m = 0.08;

std::vector<Stay> stays_of(const Snapshot& snapshot, Id object) {
  std::vector<Stay> stays;
  std::vector<TimeNs> gone;  // when it was found to be away
  for (const EventRow& event : snapshot.store().events_of(object, snapshot.as_of(), {}, {}))
    if (event.kind == EventKind::gone) gone.push_back(event.clock.valid_from);
  const auto was_away = [&](const Stay& stay, TimeNs until) {
    return std::ranges::any_of(gone,
                               [&](TimeNs time) { return time > stay.scenes.back().time && time < until; });
  };
  for (const ObjectObservation& sighting : snapshot.store().observations_of(object, snapshot.as_of())) {
    const ObservationRow& seen = sighting.observation;
    const auto place = snapshot.place_ref(seen.place);
    const bool at_place = !stays.empty() && stays.back().place.has_value() == place.has_value() &&
                          (!place || stays.back().place->id == place->id) &&
                          !was_away(stays.back(), sighting.time);
    bool same = at_place;
    if (same && seen.position && stays.back().position)
      same = (*seen.position - *stays.back().position).norm() <= kSameSpot_m;
    if (!same)
      stays.push_back(
          {.place = place, .position = seen.position, .scenes = {}, .moved_in = !stays.empty() && !at_place});
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

std::vector<AlternativeLocation> alternatives_of(const Snapshot& snapshot, const ObjectBelief& belief) {
  std::vector<AlternativeLocation> alternatives;
  if (!belief.last_seen) return alternatives;
  const Store& store = snapshot.store();
  for (const ObjectObservation& sighting :
       store.alternative_observations(belief.object.id, belief.last_seen->time, snapshot.as_of())) {
    AlternativeLocation alternative;
    alternative.probability = sighting.association.probability;
    alternative.place = snapshot.place_ref(sighting.observation.place);
    alternative.position = sighting.observation.position;
    alternative.scene = *snapshot.scene_ref(sighting.association.scene);
    for (const AssociationRow& row : store.associations(sighting.association.scene, snapshot.as_of()))
      if (row.chosen && row.object && row.observation == sighting.observation.id)
        alternative.taken_for = snapshot.object_ref(*row.object);
    alternatives.push_back(std::move(alternative));
  }
  return alternatives;
}

std::string stay_text(const Stay& stay, const TimeWriter& times) {
  const TimeNs first = stay.scenes.front().time, last = stay.scenes.back().time;
  const std::string lasted = duration_text(last - first);
  return fmt::format("{}, {}, {}{}", times.span_text(first, last), spot_text(stay.place, stay.position),
                     scenes_text(stay.scenes), lasted.empty() ? "" : ", for " + lasted + " at least");
}

const Record<Stay>& stay_record() {
  static const auto record =
      Record<Stay>("Stay")
          .time("from", [](const Stay& stay) { return stay.scenes.front().time; })
          .time("to", [](const Stay& stay) { return stay.scenes.back().time; })
          .value(
              "seconds",
              [](const Stay& stay) { return in_seconds(stay.scenes.back().time - stay.scenes.front().time); })
          .value("place", &Stay::place)
          .value("position", &Stay::position)
          .value("probability", &Stay::probability)
          .record("scenes", &Stay::scenes, scene_record());
  return record;
}

const Record<AlternativeLocation>& alternative_record() {
  static const auto record = Record<AlternativeLocation>("AlternativeLocation")
                                 .value("probability", &AlternativeLocation::probability)
                                 .record("scene", &AlternativeLocation::scene, scene_record())
                                 .value("place", &AlternativeLocation::place)
                                 .value("position", &AlternativeLocation::position)
                                 .record("taken_for", &AlternativeLocation::taken_for, object_record());
  return record;
}

}  // namespace

WhereAnswer ask(const Store& store, const WhereQuestion& question) {
  const Snapshot snapshot(store, question.as_of);
  WhereAnswer answer{.asked = question.subject};
  for (const Id object : snapshot.find_objects(question.subject)) {
    answer.objects.push_back(snapshot.object_belief(object));
    answer.objects.back().alternatives = alternatives_of(snapshot, answer.objects.back());
  }
  return answer;
}

std::string to_text(const WhereAnswer& answer, const TimeWriter& times) {
  std::vector<std::string> lines;
  if (answer.objects.size() > 1)
    lines.push_back(fmt::format("'{}' is {} objects:", answer.asked, answer.objects.size()));
  for (const ObjectBelief& object : answer.objects) {
    lines.push_back(belief_text(object, times));
    for (const AlternativeLocation& other : object.alternatives)
      lines.push_back(fmt::format("  or else {} ({}): what was seen there in scene {} is taken for {}",
                                  spot_text(other.place, other.position), percent(other.probability),
                                  other.scene.scene,
                                  other.taken_for ? to_text(*other.taken_for) : "a false cluster"));
  }
  return lines_text(lines);
}

namespace {

const Record<ObjectBelief>& located_record() {
  static const auto record = Record<ObjectBelief>("LocatedObject")
                                 .with(std::identity(), belief_record())
                                 .record("alternatives", &ObjectBelief::alternatives, alternative_record());
  return record;
}

const Record<WhereAnswer>& where_record() {
  static const auto record = Record<WhereAnswer>("WhereAnswer")
                                 .value("asked", &WhereAnswer::asked)
                                 .record("objects", &WhereAnswer::objects, located_record());
  return record;
}

}  // namespace

Json to_json(const WhereAnswer& answer) {
  return where_record().json(answer);
}

namespace {

/// Keeps the stay that comes before or after the last one at `at`; "here" is where the last one is. Before
/// "all" comes the first one.
void keep_neighbour(std::vector<Stay>& stays, const std::string& at, bool before, const Snapshot& snapshot) {
  if (at == "all") {
    if (!stays.empty()) stays.resize(1);
    return;
  }
  std::set<Id> places;
  if (at != "here")
    for (const PlaceRow& place : snapshot.find_places(at)) places.insert(place.id);
  else if (!stays.empty() && stays.back().place)
    places.insert(stays.back().place->id);
  const auto is_at = [&](const Stay& stay) { return stay.place && places.contains(stay.place->id); };
  std::optional<Stay> neighbour;
  for (size_t i = stays.size(); i-- > 0 && !neighbour;) {
    if (!is_at(stays[i])) continue;
    size_t j = i;
    if (before)
      while (j > 0 && is_at(stays[j])) --j;
    else
      while (j + 1 < stays.size() && is_at(stays[j])) ++j;
    if (!is_at(stays[j])) neighbour = stays[j];
  }
  stays.clear();
  if (neighbour) stays.push_back(std::move(*neighbour));
}

}  // namespace

HistoryAnswer ask(const Store& store, const HistoryQuestion& question) {
  const Snapshot snapshot(store, question.as_of);
  HistoryAnswer answer{.asked = question.subject};
  std::set<Id> places;
  if (!question.place.empty())
    for (const PlaceRow& place : snapshot.find_places(question.place)) places.insert(place.id);
  for (const Id object : snapshot.find_objects(question.subject)) {
    ObjectHistory history{.now = snapshot.object_belief(object), .stays = stays_of(snapshot, object)};
    std::erase_if(history.stays, [&](const Stay& stay) {
      const bool elsewhere = !places.empty() && (!stay.place || !places.contains(stay.place->id));
      return elsewhere || (question.from && stay.scenes.back().time < *question.from) ||
             (question.to && stay.scenes.front().time > *question.to);
    });
    if (!question.before.empty()) keep_neighbour(history.stays, question.before, true, snapshot);
    if (!question.after.empty()) keep_neighbour(history.stays, question.after, false, snapshot);
    for (const EventRow& event : store.events_of(object, question.as_of, question.from, question.to))
      history.changes.push_back(snapshot.change(event));
    answer.objects.push_back(std::move(history));
  }
  return answer;
}

std::vector<TimeSpan> spans_of(const std::vector<Stay>& stays) {
  std::vector<TimeSpan> spans;
  for (size_t i = 0; i < stays.size(); ++i) {
    const Stay& stay = stays[i];
    const bool goes_on = i > 0 && !stay.moved_in && stay.place && stays[i - 1].place &&
                         stays[i - 1].place->id == stay.place->id;
    if (!goes_on) spans.push_back({stay.scenes.front().time, 0});
    spans.back().last = stay.scenes.back().time;
  }
  return spans;
}

std::string to_text(const HistoryAnswer& answer, const TimeWriter& times) {
  std::vector<std::string> lines;
  for (const ObjectHistory& history : answer.objects) {
    if (!lines.empty()) lines.emplace_back();
    lines.push_back(
        fmt::format("{}, seen in {}:", to_text(history.now.object), counted(history.now.sightings, "scene")));
    // Stays and changes in one order of time.
    std::vector<std::pair<TimeNs, std::string>> entries;
    for (const Stay& stay : history.stays)
      entries.emplace_back(stay.scenes.front().time, stay_text(stay, times));
    for (const Change& change : history.changes) {
      Change brief = change;
      if (brief.object) brief.object = ObjectRef{.id = brief.object->id, .name = "it"};
      entries.emplace_back(change.time, fmt::format("at {} {}", when_text(change, times), to_text(brief)));
    }
    std::ranges::stable_sort(entries, {}, &std::pair<TimeNs, std::string>::first);
    for (const auto& [time, text] : entries) lines.push_back("  " + text);
    lines.push_back("  now: " + belief_text(history.now, times));
  }
  return lines_text(lines);
}

namespace {

const Record<ObjectHistory>& object_history_record() {
  static const auto record = Record<ObjectHistory>("ObjectHistory")
                                 .with(&ObjectHistory::now, belief_record())
                                 .record("stays", &ObjectHistory::stays, stay_record())
                                 .record("changes", &ObjectHistory::changes, change_record());
  return record;
}

const Record<HistoryAnswer>& history_record() {
  static const auto record = Record<HistoryAnswer>("HistoryAnswer")
                                 .value("asked", &HistoryAnswer::asked)
                                 .record("objects", &HistoryAnswer::objects, object_history_record());
  return record;
}

}  // namespace

Json to_json(const HistoryAnswer& answer) {
  return history_record().json(answer);
}

namespace {

std::vector<SentenceForm> where_sentences() {
  using enum Asks;
  const auto at = SentenceTime::at;
  const std::map<std::string, std::string> in_part = {{"object", "{object} in {part}"}};
  return {
      {"where: <object> "
       "[go|put|leave|lose|move|come|vanish|take|last|lately|look|location|back|belong|every]",
       place, "Where is the red cup?"},
      {"where: every <object> [put|leave]", place},
      {"where: at<place> <object> [put|leave]",
       place,
       "Where on the table is the milk?",
       {{"object", "{object} on {place}"}}},
      {"where: leave|put|lose <object> [last|find]", place, "Where did I leave my tea cup?"},
      {"bare: or <object> <any>", place, "The milk: table or counter?"},
      {"order|bare: find|lose|miss <object> [not|help|thing|where|anything|back]", place,
       "I can't find the tea."},
      {"yes: see|find <object> person [lately|last|lose] -time", place, "Have you seen my tea cup?"},
      {"what|bare|order: location <object> [last|know|see|stand|give|show|tell]", place,
       "Location of the jam?"},
      {"what: stranded <object> [stand|put|leave|keep]", place},
      {"what: contain <object> -subject", place},
      {"what: which<part> <object> [stranded|put|leave|keep|go|move|take|inside|away]", place,
       "In which drawer is the cup?", in_part},
      {"what: which<part> <object> [stranded|put|leave|keep|go|move|take|inside|away]", place},
      {"what: which<part> contain <object>", place, "", in_part},
      {"yes|bare: there|have|any|stand|room|exist <object> [leave|own|keep|thing]", exists,
       "Do we have milk?"},
      {"yes|bare: every together <object> [keep|put|leave]", together},
      {"yes|bare: together <object> [keep|put|leave]", together, "Are the cups in the same place?"},
      {"yes|bare: vanish|go|miss|lose <object> [away|every] -time", gone, "Is the plate gone?"},
      {"yes: go|miss <object> time [away] -did", gone, "Was the plate gone at four?"},
      {"yes|bare: not there <object> [leave]", gone},
      {"when: see|find <object> [last|lately]", last_time, "When was the last time you saw it?", {}, at},
      {"bare|what: see last <object>", last_time, "Last sighting of the milk?", {}, at},
      {"when|bare: see first <object>", first_time, "When did you first see the milk?", {}, at},
      {"howlong: see <object> [ago|not|last]", ago, "How long ago did you see the jam?", {}, at},
      {"howsure: <object> [where|location]", probability},
      {"howsure: about<object> [location|where]", probability, "How sure are you about the pot?"},
      {"howlong: vanish|go|miss|leave <object> [ago]", duration, "How long has the plate been missing?"},
      {"why|how: vanish|go|miss|leave|take|lose <object> [away]", reason,
       "Why do you think that the plate is gone?"},
      {"why|how: vanish|go|leave|take|move <object> <any> [away]", reason},
      {"why|how: vanish|go|leave|take|move <object> from<any> [away]", reason},
      {"why|how: know|think|sure <object> [where|location]", reason},
  };
}

std::vector<SentenceForm> history_sentences() {
  using enum Asks;
  return {
      {"where: been <object> [before|lately|else|stand|see|keep]", summary, "Where has the red cup been?"},
      {"where: before <object> [keep]", place, "Where was the red cup before?", {{"before", "here"}}},
      {"where: before move|take|put <object>", place, "", {{"before", "here"}}},
      {"where: come from <object>", place, "Where did the red cup come from?", {{"before", "here"}}},
      {"where: before<before> <object>", place},
      {"where: first <object> [see|stand|find|put|keep|leave]",
       place,
       "Where was the red cup first?",
       {{"before", "all"}}},
      {"where: before come|move|go|put|take|bring|leave <object> to<before>", place,
       "Where was the red cup before it came to the table?"},
      {"where: after<after> <object> [go|move|put|take|come]", place,
       "Where did the cup go after the table?"},
      {"where: go|move|take|put|bring from<after> <object>", place},
      {"how: go|move|act <object>"},
      {"bare|what|order: history <object> [show|list|give|location|movement]", summary,
       "History of the red cup?"},
      {"what: act <object>"},
      {"howlong: <object> at<place> [keep|leave|put]", duration, "How long was the red cup on the table?"},
      {"sincewhen: <object> at<place> [keep|back|leave|put]", first_time,
       "Since when is the milk on the table?"},
      {"untilwhen: <object> at<place> [keep|leave|put]", until, "Until when was the red cup on the table?"},
  };
}

}  // namespace

std::vector<Question> location_questions() {
  return {
      {.name = "where",
       .description = "Where an object is",
       .parameters = {object_parameter()},
       .examples = {"red", "object_1 --at 08:30 --json"},
       .answer = format::schema_by<where_record>,
       .run = [](const Arguments& given) -> Answer {
         return ask(given.store(), WhereQuestion{given.text("object"), given.as_of()});
       },
       .time = SentenceTime::moment_or_period,
       .over_period = "history",
       .sentences = where_sentences()},
      {.name = "history",
       .description = "Where an object was, over time",
       .parameters =
           {object_parameter(),
            only_place_parameter(),
            {.name = "before",
             .type = ParameterType::place,
             .help = "Only where it was before its last stay at this place; here = where it is, all = where "
                     "it was first",
             .excludes = {"after"}},
            {.name = "after",
             .type = ParameterType::place,
             .help = "Only where it was after its last stay at this place"}},
       .period = true,
       .examples = {"object_1", "red --between \"this morning\" noon --json"},
       .answer = format::schema_by<history_record>,
       .run = [](const Arguments& given) -> Answer {
         return ask(given.store(),
                    HistoryQuestion{given.text("object"), given.from(), given.to(), given.as_of(),
                                    given.text("place"), given.text("before"), given.text("after")});
       },
       .time = SentenceTime::period,
       .sentences = history_sentences(),
       .of_moment = false},
  };
}

}  // namespace loci::memory
