#include "memory/questions/objects.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>

#include "memory/questions/events.h"
#include "memory/questions/question.h"
#include "memory/questions/replies/answer_fields.h"
#include "memory/questions/replies/answer_format.h"
#include "memory/questions/replies/reply_parts.h"
#include "memory/questions/snapshot.h"

namespace loci::memory {

using namespace format;

namespace {

std::set<Id> gone_in_period(const Store& store, const ObjectsQuestion& question) {
  std::set<Id> objects;
  for (const EventRow& event : store.events(question.as_of, question.from, question.to))
    if (event.object && event.kind == EventKind::gone) objects.insert(*event.object);
  return objects;
}

std::set<Id> handled_in_period(const Store& store, const ObjectsQuestion& question) {
  std::set<Id> objects;
  const ChangesQuestion handled{
      .from = question.from, .to = question.to, .as_of = question.as_of, .kind = "handled"};
  for (const Change& change : ask(store, handled).changes)
    if (change.object) objects.insert(change.object->id);
  return objects;
}

/// Whether it was at one of the places: in a period as looks show it, else as it is believed.
class AtPlace {
 public:
  AtPlace(const Snapshot& snapshot, const ObjectsQuestion& question)
      : store_(snapshot.store()), question_(question) {
    for (const PlaceRow& place : snapshot.find_places(question.not_at)) places_.insert(place.id);
  }

  bool was(const ObjectBelief& object) const {
    if (!question_.from && !question_.to) return object.place && places_.contains(object.place->id);
    return std::ranges::any_of(
        store_.observations_of(object.object.id, question_.as_of, question_.from, question_.to),
        [&](const ObjectObservation& sighting) {
          return sighting.observation.place && places_.contains(*sighting.observation.place);
        });
  }

 private:
  const Store& store_;
  const ObjectsQuestion& question_;
  std::set<Id> places_;
};

void keep_elsewhere(const Snapshot& snapshot, const ObjectsQuestion& question, ObjectsAnswer& answer) {
  const AtPlace at_place(snapshot, question);
  const bool now = !question.from && !question.to;
  std::erase_if(answer.objects, [&](const ObjectBelief& object) {
    return at_place.was(object) || (now && object.status == ObjectStatus::gone);
  });
}

}  // namespace

ObjectsAnswer ask(const Store& store, const ObjectsQuestion& question) {
  const Snapshot snapshot(store, question.as_of);
  ObjectsAnswer answer;
  if (question.subject.empty())
    for (const BeliefRow& row : snapshot.beliefs()) answer.objects.push_back(snapshot.object_belief(row));
  else
    for (const Id object : snapshot.find_objects(question.subject))
      answer.objects.push_back(snapshot.object_belief(object));
  if (question.subject.empty() && answer.objects.empty())
    for (const SceneRow& scene : store.scenes(question.as_of))
      answer.unconfirmed += store.observations(scene.id).size();
  if (!question.not_at.empty()) {
    keep_elsewhere(snapshot, question, answer);
    return answer;
  }
  const auto seen_then = [&](const ObjectBelief& object) {
    return !store.observations_of(object.object.id, question.as_of, question.from, question.to).empty();
  };
  const bool gone = question.filter == ObjectFilter::gone, unmoved = question.filter == ObjectFilter::unmoved;
  const bool over = question.to && *question.to < TimeReader(store).now();
  const std::set<Id> left_then = gone && over ? gone_in_period(store, question) : std::set<Id>{};
  const std::set<Id> handled = unmoved ? handled_in_period(store, question) : std::set<Id>{};
  std::erase_if(answer.objects, [&](const ObjectBelief& object) {
    if (unmoved && (handled.contains(object.object.id) || !replies::is_there(object))) return true;
    const bool missing = object.status == ObjectStatus::gone || object.status == ObjectStatus::missed;
    if (gone && (!missing || (over && !left_then.contains(object.object.id)))) return true;
    if ((question.from || question.to) && !(gone && over) && !seen_then(object)) return true;
    return question.unseen_since && object.last_seen && object.last_seen->time >= *question.unseen_since;
  });
  return answer;
}

std::string to_text(const ObjectsAnswer& answer, const TimeWriter& times) {
  if (answer.objects.empty())
    return answer.unconfirmed == 0
               ? "No objects are known.\n"
               : fmt::format("No objects are known: {} {} not confirmed by another scene.\n",
                             counted(answer.unconfirmed, "observation"),
                             answer.unconfirmed == 1 ? "is" : "are");
  std::vector<std::vector<std::string>> rows = {
      {"object", "colour", "size", "place", "status", "seen", "last seen"}};
  for (const ObjectBelief& object : answer.objects) {
    const auto& [id, name, aliases, color, size, label] = object.object;
    std::vector<std::string> names = aliases;
    if (label && aliases.empty()) names.push_back(*label);
    rows.push_back({name + (names.empty() ? "" : fmt::format(" ({})", fmt::join(names, ", "))),
                    color.value_or("-"), size ? size_text(*size) : "-",
                    object.place ? place_text(*object.place) : "-", status_text(object.status),
                    std::to_string(object.sightings),
                    object.last_seen ? times.text(object.last_seen->time) : "-"});
  }
  const auto once = std::ranges::count_if(answer.objects, seen_once);
  if (once == 0) return table_text(rows);
  return table_text(rows) +
         fmt::format("{} of {} were seen in one scene only and are gone: they may be false detections\n",
                     once, answer.objects.size());
}

namespace {

const Record<ObjectsAnswer>& objects_record() {
  static const auto record =
      Record<ObjectsAnswer>("ObjectsAnswer").record("objects", &ObjectsAnswer::objects, belief_record());
  return record;
}

}  // namespace

Json to_json(const ObjectsAnswer& answer) {
  return objects_record().json(answer);
}

AboutAnswer ask(const Store& store, const AboutQuestion& question) {
  const Snapshot snapshot(store, question.as_of);
  AboutAnswer answer{.asked = question.subject};
  for (const Id id : snapshot.find_objects(question.subject)) {
    AboutObject object{.now = snapshot.object_belief(id)};
    object.facts =
        ask(store, FactsQuestion{.about = object_name(id), .key = {}, .as_of = question.as_of}).facts;
    std::vector<ObjectObservation> sightings = store.observations_of(id, question.as_of);
    if (sightings.size() > question.max_sightings)
      sightings.erase(sightings.begin(),
                      sightings.end() - static_cast<std::ptrdiff_t>(question.max_sightings));
    object.evidence = annotation_support(store, sightings, question.as_of);
    object.sightings = sightings.size();
    answer.objects.push_back(std::move(object));
  }
  return answer;
}

std::string to_text(const AboutAnswer& answer, const TimeWriter& times) {
  std::vector<std::string> lines;
  for (const AboutObject& object : answer.objects) {
    lines.push_back(belief_text(object.now, times));
    for (const Fact& fact : object.facts)
      lines.push_back(fmt::format("  {}: {} (said by {})", fact.key, fact.value, fact.source));
    for (const AnnotationSupport& one : object.evidence)
      lines.push_back(fmt::format("  {}: {} ({} of {}, {} of those that say)",
                                  one.type.substr(one.type.rfind('.') + 1), one.value, one.observations,
                                  counted(object.sightings, "sighting"), percent(one.agreement)));
    if (object.now.first_seen)
      lines.push_back(fmt::format("  first seen at {} ({}), in {}", times.text(object.now.first_seen->time),
                                  scene_text(*object.now.first_seen),
                                  counted(object.now.sightings, "scene")));
  }
  return lines_text(lines);
}

namespace {

const Record<AnnotationSupport>& support_record() {
  static const auto record = Record<AnnotationSupport>("AnnotationSupport")
                                 .value("type", &AnnotationSupport::type)
                                 .value("value", &AnnotationSupport::value)
                                 .value("sightings", &AnnotationSupport::observations)
                                 .value("agreement", &AnnotationSupport::agreement);
  return record;
}

const Record<AboutObject>& about_object_record() {
  static const auto record = Record<AboutObject>("AboutObject")
                                 .with(&AboutObject::now, belief_record())
                                 .record("facts", &AboutObject::facts, fact_record())
                                 .record("evidence", &AboutObject::evidence, support_record());
  return record;
}

const Record<AboutAnswer>& about_record() {
  static const auto record = Record<AboutAnswer>("AboutAnswer")
                                 .value("asked", &AboutAnswer::asked)
                                 .record("objects", &AboutAnswer::objects, about_object_record());
  return record;
}

}  // namespace

Json to_json(const AnnotationSupport& evidence) {
  return support_record().json(evidence);
}

Json to_json(const AboutAnswer& answer) {
  return about_record().json(answer);
}

namespace {

/// "(what|which) is biggest [on <place>]" for the words that Snapshot::find_objects() knows.
std::vector<SentenceForm> objects_sentences() {
  using enum SentenceTime;
  using enum Asks;
  const std::map<std::string, std::string> no_longer = {{"state", "gone"}}, unmoved = {{"state", "unmoved"}},
                                           known = {{"state", "known"}};
  return {
      {"what: thing person|there [know|see|have|exist]", objects, "What objects do you know?"},
      {"what: know person", objects},
      {"what: room [thing|see|know]", objects},
      {"where: everything [every|thing|stand|keep|put|leave]", place, "Where was everything at nine?"},
      {"where: every thing [stand|keep|put|leave]", place},
      {"order: show|list|name thing|everything [know]", objects},
      {"order: show|list|name <object> [everything|know|see|thing]", objects, "Show me all red objects."},
      {"what: thing <object>", objects},
      {"what: which<object> person see -time", objects},
      {"what: which<object> person|there|room|stand|exist [have|own|leave|every]", objects,
       "What red objects do you know?"},
      {"howmany: thing know person", number, "How many objects do you know?", known},
      {"howmany: <object> know person", number, "", known},
      {"howmany: <object> see person", number, "", known},
      {"howmany: <object> see time", number, "", {}, period},
      {"howmany: <object> see person time", number, "", {}, period},
      {"howmany: thing [own|leave]", number},
      {"howmany: thing see time", number, "", {}, period},
      {"howmany: <object> [own|leave|keep|room]", number, "How many red objects are there?"},
      {"yes|bare: count<count> <object> [own|have|leave|room|keep]", verdict, "Are there two cups?"},
      {"what: vanish time [thing|away]", objects, "What disappeared today?", no_longer, period},
      {"what: vanish [thing|away]", objects, "", no_longer, period},
      {"what: which<object> vanish [away]", objects, "", no_longer, period},
      {"howmany: vanish [thing|away]", number, "How many objects have disappeared?", no_longer, period},
      {"howmany: vanish <object> [away]", number, "", no_longer, period},
      {"what: go|miss time [thing|away]", objects, "What was gone at four?", no_longer, moment_or_period},
      {"what: go [thing|away]", objects, "", no_longer, moment_or_period},
      {"what: which<object> go [away]", objects, "", no_longer, moment_or_period},
      {"what: which<object> miss time", objects, "", no_longer, moment_or_period},
      {"howmany: go|miss [thing|away]", number, "", no_longer, moment_or_period},
      {"howmany: go|miss <object> [away]", number, "", no_longer, moment_or_period},
      {"what: not move [thing|take|change|throughout]", objects, "What was not moved today?", unmoved,
       period},
      {"what: not change [thing|location]", objects, "", unmoved, period},
      {"what: not move|change|take which<object> [location|throughout]", objects, "", unmoved, period},
      {"yes|bare: thing vanish [away|new]", exists, "Did anything disappear since noon?", no_longer, period},
      {"yes|bare: thing go [away|new]", exists, "", no_longer, moment_or_period},
      {"what: not at<not-at> [thing|stand|see|find|keep|put] -anymore -stays",
       objects,
       "Which objects were never on the table?",
       {},
       moment_or_period},
      {"what: not which<object> at<not-at> [stand|see|find|keep|put] -anymore -stays",
       objects,
       "",
       {},
       moment_or_period},
      {"howmany: not at<not-at> [thing|stand|see|find|keep|put] -anymore -stays",
       number,
       "",
       {},
       moment_or_period},
      {"howmany: not <object> at<not-at> [stand|see|find|keep|put] -anymore -stays",
       number,
       "",
       {},
       moment_or_period},
      {"order: show|list|name not at<not-at> [thing|everything] -anymore", objects, "", {}, moment_or_period},
      {"order: show|list|name not <object> at<not-at> -anymore", objects, "", {}, moment_or_period},
      {"where: not <object> at<not-at> -anymore", place, "Where is the cup that is not on the table?"},
      {"what: see person time [thing|everything]",
       objects,
       "What did you see between eight and nine?",
       {},
       period},
      {"what: see time [thing|everything]", objects, "", {}, period},
      {"what: which<object> see time", objects, "", {}, period},
      {"what: not see|find [thing|last]", objects, "What have you not seen since nine?", {}, since},
      {"what: most<object>", objects},
      {"what: most<object> at<place> [stand]",
       objects,
       "What is the biggest object on the table?",
       {{"object", "{object} on {place}"}}},
      {"what: thing most<object>", objects},
      {"what: which<kind> most<object>", objects, "", {{"object", "{object} {kind}"}}},
      {"what: coloured<object> [thing] -was", objects, "What is green?"},
      {"what: which<kind> coloured<object> -was",
       objects,
       "Which cup is red?",
       {{"object", "{object} {kind}"}}},
      {"howmany: <kind> coloured<object> -was", number, "", {{"object", "{object} {kind}"}}},
  };
}

std::vector<SentenceForm> about_sentences() {
  using enum Asks;
  const auto about = [](const char* name) { return std::map<std::string, std::string>{{"property", name}}; };
  return {
      {"order|bare|what: about<object> [tell|know|everything|thing]", summary,
       "What do you know about the red cup?"},
      {"order: describe <object>"},
      {"who: own|have <object>", property, "Who owns the red cup?", about("owner")},
      {"who: belong <object>", property, "", about("owner")},
      {"who: belong to<object>", property, "", about("owner")},
      {"whose: <object>", property, "", about("owner")},
      {"whose: <object> <any>", property, "", about("owner")},
      {"what|bare|order: colour <object> [have|tell|give]", property, "What colour is the cup?",
       about("colour")},
      {"yes|bare: samecolour <object> [have|in|of|every]", together, "Do all the cups have the same colour?",
       about("colour")},
      {"yes|bare: samesize <object> [have|of|every]", together, "Are the boxes the same size?",
       about("size")},
      {"what|bare|order: size <object> [have|tell|give]", property, "", about("size")},
      {"howbig: <object>", property, "How big is the bowl?", about("size")},
      {"what|bare|order: material <object> [have|tell|give]", property, "", about("material")},
      {"howlong: <object> -was -have -do -did -had -there -stand -time -see", property, "", about("size")},
      {"yes: coloured<value> <object> [every] -there", verdict, "Is the pot grey?", about("colour")},
      {"yes|bare: differentcolour <object> [have|of|every]",
       verdict,
       "Do the boxes have different colours?",
       {{"property", "colour"}, {"value", "different"}}},
      {"howoften: see <object>", number, "How often was the bowl seen?", about("sightings")},
      {"what: shape|class|kind|brand <object> [of|thing]"},
      {"what: like look <object>"},
      {"what: write|print|say on<object>"},
  };
}

}  // namespace

std::vector<Question> object_questions() {
  Parameter only = object_parameter();
  only.required = false;
  only.help = "Only these: a colour, a size, \"on table_1\"";
  only.default_text = "all";
  return {
      {.name = "objects",
       .group = QuestionGroup::inspect,
       .description = "The objects",
       .parameters = {only,
                      {.name = "state",
                       .help = "gone: only those that have gone; unmoved: only those that are there and were "
                               "not moved; known: what is there and what has gone",
                       .default_text = "any",
                       .choices = {"gone", "unmoved", "known"}},
                      {.name = "not-at",
                       .type = ParameterType::place,
                       .help = "Only those elsewhere; of a period, those that were not seen there"},
                      count_parameter(),
                      {.name = "unseen-since",
                       .type = ParameterType::time,
                       .help = "Only those that were not seen since this time"}},
       .period = true,
       .examples = {"", "red --json"},
       .answer = format::schema_by<objects_record>,
       .run = [](const Arguments& given) -> Answer {
         const std::string state = given.text("state");
         return ask(given.store(), {.subject = given.text("object"),
                                    .as_of = given.as_of(),
                                    .unseen_since = given.time("unseen-since"),
                                    .from = given.from(),
                                    .to = given.to(),
                                    .filter = state == "gone"      ? ObjectFilter::gone
                                              : state == "unmoved" ? ObjectFilter::unmoved
                                                                   : ObjectFilter::all,
                                    .not_at = given.text("not-at")});
       },
       .sentences = objects_sentences()},
      {.name = "about",
       .group = QuestionGroup::inspect,
       .description = "What is known about an object: by annotators and by people",
       .parameters = {object_parameter(),
                      {.name = "property",
                       .help = "What the reply to a sentence is about",
                       .default_text = "all",
                       .choices = {"colour", "size", "material", "owner", "sightings"}},
                      {.name = "value",
                       .help = "Whether the colour is this one, or differs between them: different",
                       .default_text = "any"}},
       .examples = {"red", "object_1 --json"},
       .answer = format::schema_by<about_record>,
       .run = [](const Arguments& given) -> Answer {
         return ask(given.store(), AboutQuestion{.subject = given.text("object"), .as_of = given.as_of()});
       },
       .sentences = about_sentences()},
  };
}

}  // namespace loci::memory
