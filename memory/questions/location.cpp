#include "memory/questions/location.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "memory/questions/answer_format.h"
#include "memory/questions/question.h"
#include "memory/questions/snapshot.h"

namespace loci::memory {

using namespace format;

namespace {

/// Observations closer than this and on the same place are one stay.
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

Json stay_json(const Stay& stay) {
  const TimeNs first = stay.scenes.front().time, last = stay.scenes.back().time;
  Json json = {{"from", format_time(first)},
               {"to", format_time(last)},
               {"seconds", static_cast<double>(last - first) / kSecond}};
  put(json, "place", stay.place, place_json);
  put(json, "position", stay.position, vector_json);
  json["probability"] = stay.probability;
  json["scenes"] = list_json(stay.scenes, scene_json);
  return json;
}

Json alternative_json(const AlternativeLocation& alternative) {
  Json json = {{"probability", alternative.probability}, {"scene", scene_json(alternative.scene)}};
  put(json, "place", alternative.place, place_json);
  put(json, "position", alternative.position, vector_json);
  put(json, "taken_for", alternative.taken_for, object_json);
  return json;
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

Json to_json(const WhereAnswer& answer) {
  return {{"asked", answer.asked}, {"objects", list_json(answer.objects, [](const ObjectBelief& object) {
                                      Json json = belief_json(object);
                                      json["alternatives"] = list_json(object.alternatives, alternative_json);
                                      return json;
                                    })}};
}

HistoryAnswer ask(const Store& store, const HistoryQuestion& question) {
  const Snapshot snapshot(store, question.as_of);
  HistoryAnswer answer{.asked = question.subject};
  const std::vector<EventRow> events = store.events(question.as_of, question.from, question.to);
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
    for (const EventRow& event : events)
      if (event.object == object) history.changes.push_back(snapshot.change(event));
    answer.objects.push_back(std::move(history));
  }
  return answer;
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

Json to_json(const HistoryAnswer& answer) {
  return {{"asked", answer.asked}, {"objects", list_json(answer.objects, [](const ObjectHistory& history) {
                                      Json json = belief_json(history.now);
                                      json["stays"] = list_json(history.stays, stay_json);
                                      json["changes"] = list_json(history.changes, change_json);
                                      return json;
                                    })}};
}

namespace {

std::vector<SentenceForm> where_sentences() {
  using enum Asks;
  const auto at = SentenceTime::at;
  const std::map<std::string, std::string> in_part = {{"object", "{object} in {part}"}};
  return {
      {"where: <object> "
       "[stand|go|find|put|leave|lose|see|move|come|vanish|take|get|last|lately|look|location|know]",
       place, "Where is the red cup?"},
      {"where: leave|put|lose <object> [last|find]", place, "Where did I leave my tea cup?"},
      {"order|bare: find|lose|miss <object> [not|help|see|thing|get|where|anything]", place,
       "I can't find the tea."},
      {"yes: see|find <object> person [lately|last|lose] -time", place, "Have you seen my tea cup?"},
      {"what|bare|order: location <object> [last|know|see|stand|give|show|tell]", place,
       "Location of the jam?"},
      {"what: stranded <object> [stand|put|leave|keep]", place},
      {"what: contain <object> -subject", place},
      {"what: which<part> <object> [stranded|stand|put|leave|find|see|inside]", place,
       "In which drawer is the cup?", in_part},
      {"what: which<part> <object> [stranded|stand|put|leave|find|see|inside]", place},
      {"what: which<part> contain <object>", place, "", in_part},
      {"yes|bare: there|have|any <object> [leave|get|own|exist|keep|see|find]", exists, "Do we have milk?"},
      {"yes|bare: exist <object>", exists},
      {"yes|bare: vanish|go|miss|lose <object> [away] -time", gone, "Is the plate gone?"},
      {"yes|bare: not there <object> [leave]", gone},
      {"when: see|find <object> [last|lately]", last_time, "When was the last time you saw it?", {}, at},
      {"bare|what: see last <object>", last_time, "Last sighting of the milk?", {}, at},
      {"when|bare: see first <object>", first_time, "When did you first see the milk?", {}, at},
      {"howlong: see <object> [ago|not|last]", ago, "How long ago did you see the jam?", {}, at},
      {"howsure: <object> [stand|where|see|location]", probability},
      {"howsure: about<object> [location]", probability, "How sure are you about the pot?"},
      {"why|how: vanish|go|miss <object> [think|know|sure|say]", reason,
       "Why do you think that the plate is gone?"},
      {"why: not <object> at<any> [think|sure]", reason},
      {"why|how: know|think|sure <object> [where|location]", reason},
  };
}

std::vector<SentenceForm> history_sentences() {
  using enum Asks;
  return {
      {"where: been <object> [before|lately|else|stand|see|keep]", summary, "Where has the red cup been?"},
      {"where: before <object> [stand|see|keep]"},
      {"how: go|move|act <object>"},
      {"bare|what|order: history <object> [show|list|give|location|movement]", summary,
       "History of the red cup?"},
      {"what: act <object>"},
      {"howlong: <object> at<place> [stand|keep|leave|see]", duration,
       "How long was the red cup on the table?"},
      {"sincewhen: <object> at<place> [stand|keep|see]", first_time, "Since when is the milk on the table?"},
  };
}

}  // namespace

std::vector<Question> location_questions() {
  return {
      {.name = "where",
       .description = "Where an object is",
       .parameters = {object_parameter()},
       .examples = {"red", "object_1 --at 08:30 --json"},
       .run = [](const Arguments& given) -> Answer {
         return ask(given.store(), WhereQuestion{given.text("object"), given.as_of()});
       },
       .time = SentenceTime::moment_or_period,
       .over_period = "history",
       .sentences = where_sentences()},
      {.name = "history",
       .description = "Where an object was, over time",
       .parameters = {object_parameter(), only_place_parameter()},
       .period = true,
       .examples = {"object_1", "red --between \"this morning\" noon --json"},
       .run = [](const Arguments& given) -> Answer {
         return ask(given.store(), HistoryQuestion{given.text("object"), given.from(), given.to(),
                                                   given.as_of(), given.text("place")});
       },
       .time = SentenceTime::period,
       .sentences = history_sentences()},
  };
}

}  // namespace loci::memory
