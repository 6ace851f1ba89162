#include "memory/questions/contents.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <set>

#include "memory/questions/question.h"
#include "memory/questions/replies/answer_fields.h"
#include "memory/questions/replies/answer_format.h"
#include "memory/questions/replies/reply_parts.h"
#include "memory/questions/snapshot.h"
#include "memory/questions/visits.h"

namespace loci::memory {

using namespace format;

namespace {

Verdict verdict_of(const std::vector<PlaceContents>& places, size_t wanted) {
  size_t there = 0;
  for (const PlaceContents& contents : places)
    for (const ObjectBelief& object : contents.there) there += object.probability >= 0.5 ? 1 : 0;
  if (there > 0) return there >= wanted ? Verdict::yes : Verdict::no;
  const bool seen_empty = std::ranges::all_of(places, [](const PlaceContents& contents) {
    return contents.there.empty() && contents.fraction.value_or(0) >= kMinSeenFraction;
  });
  return seen_empty ? Verdict::no : Verdict::not_observed;
}

bool more_probable(const ObjectBelief& a, const ObjectBelief& b) {
  return a.probability != b.probability ? a.probability > b.probability : a.object.id < b.object.id;
}

/// `meant`: the objects asked about; unset = all.
PlaceContents contents_of(const Snapshot& snapshot, const PlaceRow& place,
                          const std::optional<std::set<Id>>& meant, size_t max_gone) {
  const Store& store = snapshot.store();
  PlaceContents contents{.place = {place.id, place.name, place.container}};
  for (const Id object : snapshot.objects_at(place.id))
    if (!meant || meant->contains(object)) contents.there.push_back(snapshot.object_belief(object));
  Store::Gone gone = store.objects_gone_from(place.id, meant ? std::numeric_limits<size_t>::max() : max_gone,
                                             snapshot.as_of());
  std::erase_if(gone.objects, [&](Id object) { return meant && !meant->contains(object); });
  contents.gone_in_all = meant ? gone.objects.size() : gone.in_all;
  gone.objects.resize(std::min(gone.objects.size(), max_gone));
  for (const Id object : gone.objects) contents.gone.push_back(snapshot.object_belief(object));
  for (auto* list : {&contents.there, &contents.gone}) std::ranges::sort(*list, more_probable);
  if (const std::optional<PlaceLook> look = last_look(snapshot, place)) {
    contents.last_view = snapshot.scene_ref(look->scene);
    contents.fraction = look->fraction;
  }
  return contents;
}

std::string view_text(const PlaceContents& contents, const TimeWriter& times) {
  if (!contents.last_view) return "never looked at";
  return fmt::format("last looked at {} ({}{})", times.text(contents.last_view->time),
                     scene_text(*contents.last_view),
                     contents.fraction ? fmt::format(", {:.0f} % of it", 100 * *contents.fraction) : "");
}

/// "1 object is, perhaps 1 more": what the last look missed is not counted as there, as in the reply.
std::string count_in_words(const std::vector<ObjectBelief>& objects) {
  const auto sure = static_cast<size_t>(std::ranges::count_if(objects, replies::is_there));
  const size_t perhaps = objects.size() - sure;
  if (sure == 0) return fmt::format("Perhaps {} {}", counted(perhaps, "object"), perhaps == 1 ? "is" : "are");
  return fmt::format("{} {}{}", counted(sure, "object"), sure == 1 ? "is" : "are",
                     perhaps > 0 ? fmt::format(", perhaps {} more,", perhaps) : "");
}

const Record<PlaceContents>& place_contents_record() {
  static const auto record =
      Record<PlaceContents>("PlaceContents")
          .value("place", &PlaceContents::place)
          .value("container", [](const PlaceContents& contents) { return contents.place.container; })
          .record("objects", &PlaceContents::there, belief_record())
          .record("gone", &PlaceContents::gone, belief_record())
          .value("gone_in_all",
                 [](const PlaceContents& contents) {
                   return contents.gone_in_all > contents.gone.size() ? std::optional(contents.gone_in_all)
                                                                      : std::nullopt;
                 })
          .record("last_look", &PlaceContents::last_view, scene_record())
          .value("fraction", &PlaceContents::fraction);
  return record;
}

}  // namespace

ContentsAnswer ask(const Store& store, const ContentsQuestion& question) {
  const Snapshot snapshot(store, question.as_of);
  ContentsAnswer answer{.asked = question.place, .subject = question.subject};
  const std::vector<PlaceRow> places = snapshot.find_places(question.place);
  std::optional<std::set<Id>> meant;
  if (!question.subject.empty()) {
    const std::vector<Id> objects = snapshot.find_objects(question.subject);
    meant.emplace(objects.begin(), objects.end());
  }
  for (const PlaceRow& place : places)
    answer.places.push_back(contents_of(snapshot, place, meant, question.max_gone));
  answer.verdict = verdict_of(answer.places, question.count);
  return answer;
}

std::string to_text(const ContentsAnswer& answer, const TimeWriter& times) {
  std::vector<std::string> lines;
  for (const PlaceContents& contents : answer.places) {
    const std::string where = place_text(contents.place), view = view_text(contents, times);
    if (contents.there.empty() && !answer.subject.empty())
      lines.push_back(fmt::format("No '{}' is known to be {} ({}).", answer.subject, where, view));
    else if (contents.there.empty())
      lines.push_back(fmt::format("Nothing is known to be {} ({}).", where, view));
    else
      lines.push_back(fmt::format("{} {} ({}):", count_in_words(contents.there), where, view));
    for (const ObjectBelief& object : contents.there) lines.push_back("  " + belief_text(object, times));
    for (const ObjectBelief& object : contents.gone)
      lines.push_back("  no longer: " + belief_text(object, times));
    if (contents.gone_in_all > contents.gone.size())
      lines.push_back(fmt::format("  no longer: {} more", contents.gone_in_all - contents.gone.size()));
  }
  return lines_text(lines);
}

namespace {

const Record<ContentsAnswer>& contents_record() {
  static const auto record =
      Record<ContentsAnswer>("ContentsAnswer")
          .value("asked", &ContentsAnswer::asked)
          .value("verdict", &ContentsAnswer::verdict)
          .record("places", &ContentsAnswer::places, place_contents_record())
          .value("subject", [](const ContentsAnswer& answer) { return unless_empty(answer.subject); });
  return record;
}

}  // namespace

Json to_json(const ContentsAnswer& answer) {
  return contents_record().json(answer);
}

namespace {

/// The sentences of `on` and `in`, which differ in their preposition ($p).
std::vector<SentenceForm> contents_sentences(const std::string& preposition) {
  using enum Asks;
  const bool on = preposition == "on";
  const auto example = [on](const char* of_on, const char* of_in = "") {
    return std::string(on ? of_on : of_in);
  };
  const std::map<std::string, std::string> of_kind = {{"object", "{object} {kind}"}};
  std::vector<SentenceForm> forms = {
      {"bare: any thing $p<place> [leave|keep|put|else]", exists, ""},
      {"yes: thing $p<place> [leave|keep|put|else]", exists,
       example("Is there anything on the couch table?")},
      {"yes|bare: there|have|any|exist <object> $p<place> [leave|keep|put]", exists,
       example("Is there any cereal on the kitchen table?", "Do we have milk in the fridge?")},
      {"yes|bare: count<count> <object> $p<place> [leave|keep|put|have]", verdict,
       example("Are there two cups on the counter?")},
      {"yes|bare: every <object> $p<place> [keep|put|leave]", all, example("Are both cups on the counter?")},
      {"yes|bare: only|alone <object> $p<place> [thing|keep|leave|put]", only,
       example("Is the milk the only object on the table?")},
      {"yes|bare: back <object> $p<place> [come|put|bring|take|go|leave]", verdict,
       example("Is the tea back on the counter?")},
      {"yes|bare: <object> $p<place> [keep|put|leave|asusual]", verdict,
       example("Is the milk still on the table?")},
      {"yes|bare: nothing $p<place> [leave|else]", empty},
      {"yes|bare: nolonger <object> $p<place> [there|any|keep|put|leave]", empty,
       example("Is the milk no longer on the table?")},
      {"howsure: <object> $p<place> [keep|put|leave]", probability,
       example("How sure are you that the milk is on the table?")},
      {"why: <object> $p<place> [keep|put|leave]", reason,
       example("Why do you think that the milk is on the table?")},
      {"how: know|think|sure <object> $p<place>", reason},
      {"why: not <object> $p<place> [keep|put|leave]",
       why_not,
       example("Why is the plate not on the table?"),
       {},
       SentenceTime::at},
      {"howmany: thing $p<place> [leave|keep|last]", number, example("How many objects are on the counter?")},
      {"howmany: <object> $p<place> [leave|keep]", number, example("How many cups are on the table?")},
      {"what: $p<place> [thing|put|leave|content|else|everything|keep]", objects,
       example("What is on the table?", "What is in the first drawer?")},
      {"what: which<object> $p<place> [put|leave|else|keep]", objects,
       example("Which cup is on the counter?")},
      {"what: which<kind> $p<place> coloured<object> -was", objects, "", of_kind},
      {"what: $p<place> coloured<object> [thing] -was", objects},
      {"howmany: <kind> $p<place> coloured<object> -was", number, "", of_kind},
      {"order: show|list|name|tell|give|print|report|find|return|enumerate $p<place> "
       "[thing|everything|content|leave|keep|put]",
       objects, example("Show me everything on the shelf")},
      {"order: show|list|name|tell|print|report|return <object> $p<place> [everything]", objects},
      {"what|bare: content|list $p<place> [thing|everything]", objects},
      {"bare: thing|everything $p<place> [leave|last]", objects},
      {"when: look $p<place> [last]", last_time, example("When did you last look at the shelf?")},
      {"howlong: look $p<place> [ago|last|not]", ago, example("How long ago did you look at the shelf?")},
  };
  if (on)
    forms.insert(forms.end(), {{"yes|bare: empty <place> [every]", empty, "Is the table free?"},
                               {"yes: clean <place> -did|have|may|person", empty},
                               {"yes|bare: every|everything empty|clean|take|go|vanish|put|move|bring "
                                "from<place> [away]",
                                empty, "Has everything been cleared off the table?"},
                               {"yes|bare: everything from<place>", empty},
                               {"what: else there", objects, "", {{"place", "there"}}},
                               {"yes: full <place>", exists},
                               {"when: look|see <place> [last]", last_time},
                               {"when: look into<place> [last]", last_time},
                               {"howlong: look|see <place> [ago|last|not]", ago},
                               {"what: look like <place>", objects},
                               {"how: look <place>", objects}});
  else
    forms.insert(forms.end(), {{"what: contain <place> [thing|find]", objects},
                               {"yes: contain thing <place>", exists},
                               {"yes|bare: inside have thing <place>", exists},
                               {"yes|bare: inside have <place> <object>", exists},
                               {"what: inside have <place> [thing]", objects},
                               {"yes|bare: contain <place> <object>", exists},
                               {"bare|order|what: content <place> [show|list|name|give|tell|everything]",
                                objects, "Contents of the first drawer?"}});
  for (SentenceForm& form : forms)
    for (size_t at = form.form.find("$p"); at != std::string::npos; at = form.form.find("$p"))
      form.form.replace(at, 2, preposition);
  return forms;
}

Question contents_question(const char* name, const char* description, const std::string& example,
                           const std::string& preposition) {
  return {
      .name = name,
      .description = description,
      .parameters = {place_parameter(),
                     only_object_parameter(),
                     count_parameter(),
                     {.name = "except", .type = ParameterType::object, .help = "What the reply leaves out"}},
      .examples = {example, example + " --at 08:30"},
      .answer = format::schema_by<contents_record>,
      .run = [](const Arguments& given) -> Answer {
        ContentsQuestion question{given.text("place"), given.as_of(), given.text("object")};
        question.count = static_cast<size_t>(given.number("count").value_or(1));
        return ask(given.store(), question);
      },
      .time = SentenceTime::moment_or_period,
      .over_period = "contents-history",
      .sentences = contents_sentences(preposition)};
}

}  // namespace

std::vector<Question> contents_questions() {
  return {
      contents_question("on", "What is on a place", "table_1", "on"),
      contents_question("in", "What is in a place", "drawer_1", "in"),
  };
}

}  // namespace loci::memory
