#include "memory/questions/comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <map>
#include <opencv2/imgproc.hpp>

#include "memory/questions/contents.h"
#include "memory/questions/environment.h"
#include "memory/questions/events.h"
#include "memory/questions/location.h"
#include "memory/questions/replies/answer_fields.h"
#include "memory/questions/replies/answer_format.h"
#include "memory/questions/replies/reply_parts.h"
#include "memory/questions/snapshot.h"

namespace loci::memory {

using namespace format;

namespace {

bool is_of_height(const std::string& by) {
  return by == "taller" || by == "shorter";
}
bool is_of_size(const std::string& by) {
  return by == "bigger" || by == "smaller" || is_of_height(by);
}
bool is_of_time(const std::string& by) {
  return by.ends_with("-before");
}

bool is_of_distance(const std::string& by) {
  return by == "distance" || by == "nearer";
}

/// The most probable object that words mean, which has not gone.
Compared compared_object(const Snapshot& snapshot, const std::string& subject) {
  const std::vector<Id> found = snapshot.find_objects(subject);
  const auto there = std::ranges::find_if(found, [&](Id id) {
    const BeliefRow* belief = snapshot.belief(id);
    return belief != nullptr && belief->status != ObjectStatus::gone;
  });
  const Id id = there == found.end() ? found.front() : *there;
  return {.name = object_name(id), .object = id};
}

/// Furniture, by the height of its surface or its own.
Compared compared_part(const Store& store, const std::string& subject, const AsOf& as_of) {
  const EnvironmentPart part = ask(store, RoomQuestion{.part = subject, .as_of = as_of}).parts.front();
  Compared one{.name = name_in_words(part.name)};
  if (part.height || part.size) one.value = part.height ? *part.height : part.size->z();
  return one;
}

std::optional<Vector3d> position_of(const Snapshot& snapshot, const Compared& one) {
  const BeliefRow* belief = snapshot.belief(*one.object);
  return belief == nullptr || belief->status == ObjectStatus::gone ? std::nullopt : belief->position;
}

std::optional<double> distance_between(const Snapshot& snapshot, const Compared& a, const Compared& b) {
  const auto from = position_of(snapshot, a), to = position_of(snapshot, b);
  return from && to ? std::optional((*to - *from).norm()) : std::nullopt;
}

/// Over the floor: 0 over the place, unset where its outline is not known.
std::optional<double> distance_to_place(const Vector3d& point, const PlaceRow& place) {
  if (place.outline.size() < 3) return std::nullopt;
  std::vector<cv::Point2f> outline;
  for (const Vector2d& corner : place.outline)
    outline.emplace_back(static_cast<float>(corner.x()), static_cast<float>(corner.y()));
  const cv::Point2f at(static_cast<float>(point.x()), static_cast<float>(point.y()));
  return std::max(0.0, -cv::pointPolygonTest(outline, at, true));
}

/// Its height, else its volume.
std::optional<double> size_of(const Snapshot& snapshot, const Compared& one, bool height) {
  const auto size = snapshot.object_ref(*one.object).size;
  if (!size) return std::nullopt;
  return height ? size->z() : size->prod();
}

constexpr TimeNs kNever = std::numeric_limits<TimeNs>::max();

/// What was last seen there cannot have left before.
std::optional<TimeSpan> not_left_before(const Snapshot& snapshot, Id object, const std::string& place) {
  const ObjectBelief belief = snapshot.object_belief(object);
  const auto is_place = [&](const PlaceRow& row) { return belief.place && belief.place->id == row.id; };
  const bool there = place.empty() || std::ranges::any_of(snapshot.find_places(place), is_place);
  if (!there || !belief.last_seen || belief.status == ObjectStatus::gone) return std::nullopt;
  return TimeSpan{belief.last_seen->time, kNever};
}

/// The last time that it left, came, was moved or opened; of several objects that of the last one.
void set_last_change(const Snapshot& snapshot, const std::string& subject, const ComparisonQuestion& question,
                     Compared& one) {
  static const std::map<std::string, std::string> kinds = {{"left-before", "left"},
                                                           {"came-before", "came"},
                                                           {"moved-before", "handled"},
                                                           {"opened-before", "opened"}};
  ChangesQuestion changes{
      .subject = subject, .place = question.place, .as_of = question.as_of, .kind = kinds.at(question.by)};
  if (question.by == "opened-before") std::swap(changes.subject, changes.place);
  for (const Change& change : ask(snapshot.store(), changes).changes) {
    if (one.time && change.time < one.time->last) continue;
    one.time = bounds_of(change);
    if (change.object) one = {.name = change.object->name, .object = change.object->id, .time = one.time};
  }
  if (!one.time && question.by == "left-before")
    one.time = not_left_before(snapshot, *one.object, question.place);
}

/// When looks saw the place.
std::vector<TimeNs> looks_at(const Snapshot& snapshot, const std::string& place) {
  std::vector<TimeNs> times;
  for (const PlaceRow& row : snapshot.find_places(place))
    for (const VisibilityRow& view : snapshot.store().visibility_of_place(row.id))
      if (const SceneRow* scene = snapshot.scene(view.scene);
          scene != nullptr && view.fraction.value_or(0) >= kMinSeenFraction)
        times.push_back(scene->time);
  std::ranges::sort(times);
  return times;
}

/// How long it was there: at least from the first to the last sighting of each stay, at most from the look
/// before to the look after them.
void set_time_at_place(const Snapshot& snapshot, const ComparisonQuestion& question, Compared& one) {
  const HistoryAnswer history =
      ask(snapshot.store(),
          HistoryQuestion{.subject = one.name, .as_of = question.as_of, .place = question.place});
  const std::vector<TimeNs> looks = looks_at(snapshot, question.place);
  for (const TimeSpan& span : spans_of(history.objects.front().stays)) {
    const auto first = std::ranges::lower_bound(looks, span.first);
    const auto after = std::ranges::upper_bound(looks, span.last);
    const TimeNs earliest = first == looks.begin() ? span.first : *std::prev(first);
    const TimeNs latest = after == looks.end() ? span.last : *after;
    one.value = one.value.value_or(0) + in_seconds(span.last - span.first);
    one.max_value = one.max_value.value_or(0) + in_seconds(latest - earliest);
  }
}

/// How many there are of what words mean.
size_t number_of(const Snapshot& snapshot, const std::string& subject) {
  return static_cast<size_t>(std::ranges::count_if(snapshot.find_objects(subject), [&](Id id) {
    const BeliefRow* belief = snapshot.belief(id);
    return belief != nullptr && belief->status != ObjectStatus::gone;
  }));
}

size_t number_on(const Store& store, const std::string& place, AsOf as_of) {
  size_t number = 0;
  for (const PlaceContents& contents : ask(store, ContentsQuestion{.place = place, .as_of = as_of}).places)
    number += static_cast<size_t>(std::ranges::count_if(contents.there, replies::is_there));
  return number;
}

Verdict verdict_of(bool is) {
  return is ? Verdict::yes : Verdict::no;
}

/// From the values of those compared.
Verdict verdict_of(const ComparisonAnswer& answer) {
  const std::vector<Compared>& all = answer.compared;
  if (is_of_time(answer.by)) {
    if (!all[0].time || !all[1].time) return Verdict::not_observed;
    const std::partial_ordering order = order_of(*all[0].time, *all[1].time);
    return order < 0 ? Verdict::yes : order > 0 ? Verdict::no : Verdict::not_observed;
  }
  if (answer.by == "distance") return all[1].value ? Verdict::yes : Verdict::not_observed;
  const Compared &a = all[answer.by == "nearer" ? 1 : 0], &b = all[answer.by == "nearer" ? 2 : 1];
  if (!a.value || !b.value) return Verdict::not_observed;
  if (answer.by == "longer")
    return *a.value > *b.max_value   ? Verdict::yes
           : *b.value > *a.max_value ? Verdict::no
                                     : Verdict::not_observed;
  const bool more =
      answer.by == "bigger" || answer.by == "taller" || answer.by == "more" || answer.by == "more-objects";
  return verdict_of(more ? *a.value > *b.value : *a.value < *b.value);
}

/// "56 cm", "1.2 l", "3 objects", "between 08:00 and 09:30".
std::string value_text(const std::string& by, const Compared& one, const TimeWriter& times) {
  constexpr double kLitres = 1000;
  if (one.time) return uncapitalised(replies::between_text(*one.time, times));
  if (!one.value) return "not known";
  const auto seconds = [](double value) { return static_cast<TimeNs>(value) * kSecond; };
  if (by == "longer")
    return uncapitalised(replies::bounds_text(seconds(*one.value), seconds(*one.max_value)));
  if (is_of_size(by) && !is_of_height(by)) return fmt::format("{:.2g} l", kLitres * *one.value);
  if (by == "more-objects") return fmt::format("{:.0f}", *one.value);
  if (by == "more") return fmt::format("{:.0f} {}", *one.value, *one.value == 1 ? "object" : "objects");
  return fmt::format("{:.0f} cm", 100 * *one.value);
}

/// "left between 08:00 and 09:30", "was still there at 09:30", "was not seen to leave"
std::string event_text(const std::string& by, const Compared& one, const TimeWriter& times) {
  static const std::map<std::string, std::pair<const char*, const char*>> verbs = {
      {"left-before", {"left", "leave"}},
      {"came-before", {"came", "come"}},
      {"moved-before", {"moved", "move"}},
      {"opened-before", {"was opened", "open"}}};
  const auto& [past, infinitive] = verbs.at(by);
  if (!one.time) return fmt::format("was not seen to {}", infinitive);
  return one.time->last == kNever ? "was still there at " + times.text(one.time->first)
                                  : fmt::format("{} {}", past, value_text(by, one, times));
}

/// "the tea is 56 cm from the oil"
std::string statement(const ComparisonAnswer& answer, const std::vector<std::string>& names,
                      const TimeWriter& times) {
  const std::vector<Compared>& all = answer.compared;
  const auto value = [&](size_t i) { return value_text(answer.by, all[i], times); };
  if (answer.by == "distance") return fmt::format("{} is {} from {}", names[0], value(1), names[1]);
  if (answer.by == "nearer")
    return fmt::format("{} is {} from {} and {} from {}", names[0], value(1), names[1], value(2), names[2]);
  if (answer.by == "more") return fmt::format("{} on {}, {} on {}", value(0), names[0], value(1), names[1]);
  if (answer.by == "more-objects")
    return fmt::format("{} × {}, {} × {}", value(0), names[0], value(1), names[1]);
  if (is_of_height(answer.by))
    return fmt::format("{} is {} high, {} {}", names[0], value(0), names[1], value(1));
  if (is_of_time(answer.by)) {
    const auto happened = [](const Compared& one) { return one.time && one.time->last != kNever; };
    const bool both = happened(all[0]) && happened(all[1]);
    return fmt::format("{} {}, {} {}", names[0], event_text(answer.by, all[0], times), names[1],
                       both ? value(1) : event_text(answer.by, all[1], times));
  }
  return fmt::format("{} {} {}, {} {}", names[0], answer.by == "longer" ? "was there" : "takes up", value(0),
                     names[1], value(1));
}

std::vector<std::string> plain_names(const ComparisonAnswer& answer) {
  std::vector<std::string> names;
  for (const Compared& one : answer.compared) names.push_back(one.name);
  return names;
}

}  // namespace

ComparisonAnswer ask(const Store& store, const ComparisonQuestion& question) {
  const Snapshot snapshot(store, question.as_of);
  ComparisonAnswer answer{.by = question.by};
  if (question.by == "longer" && question.place.empty())
    throw Error("'longer' compares times at a place", {}, "name it with --place");
  if (question.by == "nearer" && question.than.empty())
    throw Error("'nearer' compares two distances", {}, "name the other object, too (than)");
  std::vector<std::string> subjects = {question.subject, question.with};
  if (question.by == "nearer") subjects.push_back(question.than);
  for (const std::string& subject : subjects) {
    if (question.by == "more") {
      answer.compared.push_back({.name = name_in_words(snapshot.find_places(subject).front().name)});
      answer.compared.back().value = static_cast<double>(number_on(store, subject, question.as_of));
      continue;
    }
    if (question.by == "more-objects") {
      answer.compared.push_back({.name = subject});
      answer.compared.back().value = static_cast<double>(number_of(snapshot, subject));
      continue;
    }
    if (const auto places = snapshot.places_called(subject);
        is_of_distance(question.by) && !answer.compared.empty() && !places.empty()) {
      answer.compared.push_back({.name = places.front().name});
      if (const auto from = position_of(snapshot, answer.compared[0]))
        answer.compared.back().value = distance_to_place(*from, places.front());
      continue;
    }
    if (question.by == "opened-before") {
      answer.compared.push_back({.name = name_in_words(subject)});
      set_last_change(snapshot, subject, question, answer.compared.back());
      continue;
    }
    if (is_of_height(question.by) && !snapshot.means_objects(subject)) {
      answer.compared.push_back(compared_part(store, subject, question.as_of));
      continue;
    }
    Compared one = compared_object(snapshot, subject);
    if (is_of_size(question.by)) one.value = size_of(snapshot, one, is_of_height(question.by));
    if (question.by == "longer") set_time_at_place(snapshot, question, one);
    if (is_of_time(question.by)) set_last_change(snapshot, subject, question, one);
    if (is_of_distance(question.by) && !answer.compared.empty())
      one.value = distance_between(snapshot, answer.compared[0], one);
    answer.compared.push_back(std::move(one));
  }
  answer.verdict = verdict_of(answer);
  return answer;
}

std::string to_text(const ComparisonAnswer& answer, const TimeWriter& times) {
  return (answer.by == "distance" ? "" : to_text(answer.verdict) + ": ") +
         statement(answer, plain_names(answer), times) + "\n";
}

namespace {

const Record<Compared>& compared_record() {
  static const auto record = Record<Compared>("Compared")
                                 .value("name", &Compared::name)
                                 .value("value", &Compared::value)
                                 .time("until", [](const Compared& one) {
                                   const bool happened = one.time && one.time->last != kNever;
                                   return happened ? std::optional(one.time->last) : std::nullopt;
                                 });
  return record;
}

const Record<ComparisonAnswer>& comparison_record() {
  static const auto record = Record<ComparisonAnswer>("ComparisonAnswer")
                                 .value("by", &ComparisonAnswer::by)
                                 .value("verdict", &ComparisonAnswer::verdict)
                                 .record("compared", &ComparisonAnswer::compared, compared_record());
  return record;
}

}  // namespace

Json to_json(const ComparisonAnswer& answer) {
  return comparison_record().json(answer);
}

void write_reply(const ComparisonAnswer& answer, const ReplyContext& context, Reply& reply) {
  const Snapshot snapshot(context.store, context.as_of);
  const Names names(snapshot);
  std::vector<std::string> said;
  for (const Compared& one : answer.compared)
    said.push_back(one.object ? names.subject(snapshot.object_ref(*one.object)) : one.name);
  const std::string text = statement(answer, said, context.times);
  reply.not_known = answer.verdict == Verdict::not_observed;
  if (answer.by == "distance") {
    reply.text =
        reply.not_known ? fmt::format("Not known: where {} and {} both are.", said[0], said[1]) : text + ".";
    return;
  }
  // "Which is bigger?" names one.
  const bool which = context.query.asks == Asks::objects;
  if (which && !reply.not_known) {
    const size_t one = (answer.by == "nearer" ? 1 : 0) + (answer.verdict == Verdict::yes ? 0 : 1);
    if (answer.compared[one].object) reply.objects = {*answer.compared[one].object};
    reply.text = fmt::format("{}: {}.", said[one], text);
    return;
  }
  reply.verdict = answer.verdict;
  reply.text = fmt::format("{}: {}.",
                           answer.verdict == Verdict::yes  ? "Yes"
                           : answer.verdict == Verdict::no ? "No"
                                                           : "Not observed",
                           text);
}

std::vector<Question> comparison_questions() {
  const auto by = [](const char* what) { return std::map<std::string, std::string>{{"by", what}}; };
  using enum Asks;
  return {
      {.name = "compare",
       .description =
           "Two objects against each other: distance, size, what left or moved first; or two places",
       .parameters =
           {{.name = "object",
             .type = ParameterType::spot,
             .help = "An object; for more a place",
             .positional = true,
             .required = true},
            {.name = "with",
             .type = ParameterType::spot,
             .help = "The other one; for distances a place, too",
             .required = true},
            {.name = "than", .type = ParameterType::spot, .help = "Nearer than to this object or place"},
            {.name = "place",
             .type = ParameterType::place,
             .help = "That it left, came to or, for longer, was at"},
            {.name = "by",
             .help = "What is compared",
             .default_text = "distance",
             .choices = {"distance", "nearer", "bigger", "smaller", "taller", "shorter", "left-before",
                         "came-before", "moved-before", "opened-before", "longer", "more", "more-objects"}}},
       .asks = verdict,
       .examples = {"green --with red", "green --with red --by bigger --json"},
       .answer = format::schema_by<comparison_record>,
       .run = [](const Arguments& given) -> Answer {
         ComparisonQuestion question{.subject = given.text("object"),
                                     .with = given.text("with"),
                                     .than = given.text("than"),
                                     .place = given.text("place"),
                                     .as_of = given.as_of()};
         if (!given.text("by").empty()) question.by = given.text("by");
         return ask(given.store(), question);
       },
       .sentences = {
           {"howfar: <object> from<with> [away|apart]", property, "How far is the tea from the oil?",
            by("distance")},
           {"howfar: <object> and<with> [apart|away|from]", property, "", by("distance")},
           {"what|bare: distance between<object> and<with>", property, "", by("distance")},
           {"what|bare: distance from<object> to<with>", property, "", by("distance")},
           {"what|bare: distance of<object> to<with>", property, "", by("distance")},
           {"yes|bare: nearer|nearest <object> to<with> than<than>", verdict,
            "Is the tea nearer to the oil than the pot?", by("nearer")},
           {"yes|what: nearer|nearest <object> to<with> to<than>", objects,
            "Is the tea nearer to the oil or to the pot?", by("nearer")},
           {"yes|bare: bigger <object> than<with>", verdict, "Is the pot bigger than the cup?", by("bigger")},
           {"yes|bare: smaller <object> than<with>", verdict, "", by("smaller")},
           {"yes|bare: taller <object> than<with>", verdict, "Is the milk taller than the oil?",
            by("taller")},
           {"yes|bare: shorter <object> than<with>", verdict, "", by("shorter")},
           {"what: taller <object> and<with>", objects, "", by("taller")},
           {"what: shorter <object> and<with>", objects, "", by("shorter")},
           {"what: bigger <object> and<with>", objects, "", by("bigger")},
           {"what: smaller <object> and<with>", objects, "", by("smaller")},
           {"yes: vanish|go|leave|take <object> before<with> [away]", verdict,
            "Did the plate disappear before the bowl?", by("left-before")},
           {"yes: before vanish|go|leave|take <object> than<with> [away]", verdict, "", by("left-before")},
           {"yes: leave <object> <place> before<with>", verdict, "", by("left-before")},
           {"yes: vanish|go|leave|take|move <object> from<place> before<with> [away]", verdict, "",
            by("left-before")},
           {"yes: come <object> before<with>", verdict, "", by("came-before")},
           {"yes: come <object> <place> before<with>", verdict, "", by("came-before")},
           {"yes: come|put|bring|move <object> to<place> before<with>", verdict,
            "Did the cup come to the table before the bowl?", by("came-before")},
           {"yes: was <object> at<place> before<with>", verdict, "", by("came-before")},
           {"yes|bare: longer <object> at<place> than<with> [keep|leave]", verdict,
            "Was the plate on the table longer than the bowl?", by("longer")},
           {"what: longer at<place> <object> or<with> [keep|leave]", objects, "", by("longer")},
           {"what: longer <object> or<with> at<place> [keep|leave]", objects, "", by("longer")},
           {"yes: opened <object> before<with>", verdict, "Was drawer 2 opened before drawer 1?",
            by("opened-before")},
           {"yes: did|have open <object> before<with>", verdict, "", by("opened-before")},
           {"yes: move <object> before<with>", verdict, "", by("moved-before")},
           {"yes: vanish|go|leave|take <with> after<object> [away]", verdict, "", by("left-before")},
           {"yes: leave <with> <place> after<object>", verdict,
            "Did the cup leave the table after the plate?", by("left-before")},
           {"yes: vanish|go|leave|take|move <with> from<place> after<object> [away]", verdict, "",
            by("left-before")},
           {"yes: come <with> after<object>", verdict, "", by("came-before")},
           {"yes: come <with> <place> after<object>", verdict, "", by("came-before")},
           {"yes: come|put|bring|move <with> to<place> after<object>", verdict, "", by("came-before")},
           {"yes: opened <with> after<object>", verdict, "", by("opened-before")},
           {"yes: did|have open <with> after<object>", verdict, "", by("opened-before")},
           {"yes: move <with> after<object>", verdict, "", by("moved-before")},
           {"yes: before move <object> than<with>", verdict, "", by("moved-before")},
           {"yes: outnumber <object> <with>", verdict, "Do the cups outnumber the pots?", by("more-objects")},
           {"yes|bare: morethings than at<object> at<with>", verdict,
            "Is there more on the counter than on the table?", by("more")}}}};
}

}  // namespace loci::memory
