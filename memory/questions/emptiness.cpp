#include "memory/questions/emptiness.h"

#include <fmt/format.h>

#include <algorithm>

#include "mapping/base/text/text.h"
#include "memory/questions/replies/answer_fields.h"
#include "memory/questions/replies/answer_format.h"
#include "memory/questions/replies/reply_parts.h"
#include "memory/questions/routines/routines.h"
#include "memory/questions/snapshot.h"

namespace loci::memory {

using namespace format;
using namespace replies;

namespace {

/// The scenes of the period that saw some of a place, in order of time.
std::vector<SceneRef> views_of(const Snapshot& snapshot, Id place, const EmptinessQuestion& question,
                               double min_fraction) {
  std::vector<SceneRef> views;
  for (const VisibilityRow& view : snapshot.store().visibility_of_place(place, question.from, question.to)) {
    const SceneRow* scene = snapshot.scene(view.scene);
    if (scene != nullptr && view.fraction.value_or(0) >= min_fraction)
      views.push_back(snapshot.scene_ref(*scene));
  }
  return views;
}

/// When objects were at a place.
std::vector<TimeSpan> occupied_spans(const Store& store, const PlaceRow& place, const AsOf& as_of) {
  std::vector<TimeSpan> occupied;
  for (const PlaceContentsHistory& history :
       ask(store, ContentsHistoryQuestion{.place = place.name, .as_of = as_of}).places)
    for (const PastContent& object : history.objects)
      for (const TimeSpan& span : spans_at(store, as_of, object, history.place)) occupied.push_back(span);
  return occupied;
}

PlaceEmptiness emptiness_of(const Snapshot& snapshot, const PlaceRow& place,
                            const EmptinessQuestion& question) {
  constexpr double kSome = 0.02;  // less is an edge of it
  const std::vector<SceneRef> looks = views_of(snapshot, place.id, question, kMinSeenFraction);
  PlaceEmptiness result{.place = {place.id, place.name, place.container},
                        .views = views_of(snapshot, place.id, question, kSome),
                        .looks = looks.size()};
  if (looks.empty()) return result;
  result.first = looks.front();
  result.last = looks.back();
  result.occupied_throughout = true;
  const std::vector<TimeSpan> occupied = occupied_spans(snapshot.store(), place, question.as_of);
  const auto objects_between = [&](TimeNs from, TimeNs to) {
    return static_cast<size_t>(std::ranges::count_if(
        occupied, [&](const TimeSpan& span) { return span.first <= from && span.last >= to; }));
  };
  for (size_t i = 0; i < looks.size(); ++i) {
    const size_t there = objects_between(looks[i].time, looks[i].time);
    if (there == 0) result.empty.push_back(looks[i]);
    if (there > result.most) {
      result.most = there;
      result.fullest = looks[i];
    }
    const TimeNs next = i + 1 < looks.size() ? looks[i + 1].time : looks[i].time;
    result.occupied_throughout = result.occupied_throughout && objects_between(looks[i].time, next) > 0;
  }
  return result;
}

}  // namespace

EmptinessAnswer ask(const Store& store, const EmptinessQuestion& question) {
  const Snapshot snapshot(store, question.as_of);
  EmptinessAnswer answer{.asked = question.place};
  for (const PlaceRow& place : snapshot.find_places(question.place))
    answer.places.push_back(emptiness_of(snapshot, place, question));
  return answer;
}

std::string to_text(const EmptinessAnswer& answer, const TimeWriter& times) {
  std::vector<std::string> lines;
  for (const PlaceEmptiness& place : answer.places) {
    const std::string looks = counted(place.looks, "look");
    lines.push_back(fmt::format("{}: empty in {} of {}", place.place.name, place.empty.size(), looks));
    for (const SceneRef& scene : place.empty)
      lines.push_back(fmt::format("  {} ({})", times.text(scene.time), scene_text(scene)));
  }
  return lines_text(lines);
}

namespace {

const Record<PlaceEmptiness>& place_emptiness_record() {
  static const auto record = Record<PlaceEmptiness>("PlaceEmptiness")
                                 .value("place", &PlaceEmptiness::place)
                                 .record("views", &PlaceEmptiness::views, scene_record())
                                 .value("looks", &PlaceEmptiness::looks)
                                 .record("empty", &PlaceEmptiness::empty, scene_record())
                                 .record("first_look", &PlaceEmptiness::first, scene_record())
                                 .record("last_look", &PlaceEmptiness::last, scene_record())
                                 .record("fullest", &PlaceEmptiness::fullest, scene_record())
                                 .value("most", &PlaceEmptiness::most)
                                 .value("occupied_throughout", &PlaceEmptiness::occupied_throughout);
  return record;
}

const Record<EmptinessAnswer>& emptiness_record() {
  static const auto record = Record<EmptinessAnswer>("EmptinessAnswer")
                                 .value("asked", &EmptinessAnswer::asked)
                                 .record("places", &EmptinessAnswer::places, place_emptiness_record());
  return record;
}

/// Whether at least half of the period asked about, or of the memory's, lies between the first look and the
/// last one.
bool covers_period(const PlaceEmptiness& place, const ReplyContext& context) {
  const TimeReader times(context.store);
  const auto from = times.try_read(context.query.argument("from")),
             to = times.try_read(context.query.argument("to"));
  const TimeNs first = from ? from->first : times.first_scene().value_or(place.first->time),
               last = to ? std::min(to->last, times.now()) : times.now();
  return 2 * (place.last->time - place.first->time) >= last - first;
}

/// Whether, or when, it was empty where no look found it so.
void never_empty(const PlaceEmptiness& place, const ReplyContext& context, Reply& reply) {
  const std::string never =
      fmt::format("{} was not empty in {}, {}", place.place.name, counted(place.looks, "look"),
                  context.times.span_text(place.first->time, place.last->time));
  const bool verdict = context.query.asks == Asks::verdict;
  reply.not_known = !verdict;
  if (verdict)
    reply.verdict =
        place.occupied_throughout && covers_period(place, context) ? Verdict::no : Verdict::not_observed;
  reply.text = fmt::format("{}: {}.",
                           !verdict                       ? "Not known"
                           : reply.verdict == Verdict::no ? "No"
                                                          : "Not observed",
                           never);
}

/// How many objects were there at most, or when.
void write_most(const EmptinessAnswer& answer, const ReplyContext& context, Reply& reply) {
  const PlaceEmptiness& place = *std::ranges::max_element(answer.places, {}, &PlaceEmptiness::most);
  reply.places = {place.place.name};
  reply.number = place.most;
  if (!place.fullest) {
    reply.not_known = place.looks == 0;
    reply.text = place.looks == 0 ? fmt::format("Not observed: nobody looked {} then.", in_words(place.place))
                                  : fmt::format("None: {} was empty in each look.", place.place.name);
    return;
  }
  const std::string count = counted(place.most, "object") + (place.most == 1 ? " was" : " were"),
                    when = context.times.text(place.fullest->time);
  reply.time = at_once(place.fullest->time);
  reply.text = context.query.asks == Asks::most
                   ? fmt::format("{} at most: {} {} at {}.", place.most, count, in_words(place.place), when)
                   : fmt::format("At {}: {} {} then.", when, count, in_words(place.place));
  reply.evidence.push_back(fmt::format("the fullest of {}", counted(place.looks, "look")));
}

/// Whether anybody looked: a view of a corner does not count.
void write_views(const EmptinessAnswer& answer, const ReplyContext& context, Reply& reply) {
  const PlaceEmptiness& place = *std::ranges::max_element(answer.places, {}, &PlaceEmptiness::looks);
  reply.places = {place.place.name};
  if (place.looks > 0) {
    reply.verdict = Verdict::yes;
    reply.time = at_once(place.last->time);
    reply.text = fmt::format("Yes: {} was looked at {}, last at {}.", place.place.name,
                             place.looks == 1 ? "once" : counted(place.looks, "time"),
                             context.times.text(place.last->time));
  } else if (place.views.empty()) {
    reply.verdict = Verdict::no;
    reply.text = fmt::format("No: nobody looked at {} then.", place.place.name);
  } else {
    reply.verdict = Verdict::no;
    reply.text = fmt::format("Hardly: less than half of {} was in view, last at {}.", place.place.name,
                             context.times.text(place.views.back().time));
  }
}

}  // namespace

Json to_json(const EmptinessAnswer& answer) {
  return emptiness_record().json(answer);
}

void write_reply(const EmptinessAnswer& answer, const ReplyContext& context, Reply& reply) {
  const PlaceEmptiness* found = &answer.places.front();  // of several, the one that was empty last
  for (const PlaceEmptiness& place : answer.places)
    if (!place.empty.empty() && (found->empty.empty() || place.empty.back().time > found->empty.back().time))
      found = &place;
  const Asks asks = context.query.asks;
  if (asks == Asks::exists) return write_views(answer, context, reply);
  if (asks == Asks::most || asks == Asks::first_time) return write_most(answer, context, reply);
  reply.places = {found->place.name};
  if (asks == Asks::number) reply.number = found->empty.size();
  if (found->looks == 0) {
    if (asks == Asks::verdict) reply.verdict = Verdict::not_observed;
    reply.not_known = true;
    reply.text = fmt::format("Not observed: nobody looked {} then.", in_words(found->place));
    return;
  }
  if (found->empty.empty() && asks != Asks::number) return never_empty(*found, context, reply);
  for (const SceneRef& scene : found->empty)
    reply.evidence.push_back(
        fmt::format("{} was empty at {}", found->place.name, context.times.text(scene.time)));
  const std::string counts = fmt::format("in {} of {}", found->empty.size(), counted(found->looks, "look"));
  if (asks == Asks::number) {
    reply.text = fmt::format("{} was empty {}.", found->place.name, counts);
    return;
  }
  const TimeNs last = found->empty.back().time;
  reply.time = at_once(last);
  if (asks == Asks::verdict) reply.verdict = Verdict::yes;
  reply.text = asks == Asks::verdict
                   ? fmt::format("Yes: {} was empty {}, last at {}.", found->place.name, counts,
                                 context.times.text(last))
                   : fmt::format("At {}: {} was empty then.", context.times.text(last), found->place.name);
}

std::vector<Question> emptiness_questions() {
  using enum Asks;
  return {{.name = "empty",
           .description = "When a place was looked at, when with nothing on or in it, and when with most",
           .parameters = {place_parameter()},
           .period = true,
           .asks = last_time,
           .examples = {"table_1", "drawer_1 --from 09:00 --json"},
           .answer = format::schema_by<emptiness_record>,
           .run = [](const Arguments& given) -> Answer {
             return ask(given.store(),
                        EmptinessQuestion{given.text("place"), given.as_of(), given.from(), given.to()});
           },
           .time = SentenceTime::period,
           .sentences = {{"yes: everempty <place>", verdict, "Was the table ever empty?"},
                         {"when: everempty <place> [last]", last_time, "When was the table last empty?"},
                         {"howoften: empty|everempty <place>", number, "How often was the table empty?"},
                         {"yes: look at<place> [person|ever]", exists, "Did you look at the table?"},
                         {"howmany: mostthings <place>", most},
                         {"when: mostthings <place>", first_time, "When was the table the fullest?"},
                         {"when: mostthings at<place> [thing]", first_time}},
           .of_moment = false}};
}

}  // namespace loci::memory
