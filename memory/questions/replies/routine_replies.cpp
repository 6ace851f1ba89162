// The replies about what is usual, what is together, and what to do.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "memory/questions/contents.h"
#include "memory/questions/environment_parts.h"
#include "memory/questions/location.h"
#include "memory/questions/names/names.h"
#include "memory/questions/replies/answer_format.h"
#include "memory/questions/replies/reply_parts.h"
#include "memory/questions/routines/co_occurrence.h"
#include "memory/questions/routines/digest.h"
#include "memory/questions/routines/routines.h"
#include "memory/questions/routines/tasks.h"
#include "memory/questions/search.h"

namespace loci::memory {

using namespace format;
using namespace replies;

namespace {

/// Where it is most often: several where it was seen as often at each.
std::vector<PlaceRef> tied_places(const UsualObject& object) {
  std::vector<PlaceRef> places;
  for (const UsualPlace& place : object.places)
    if (place.sightings == object.places.front().sightings) places.push_back(place.place);
  return places;
}

/// "on counter_1", "on counter_1 or on table_1".
std::string usual_spot(const UsualObject& object) {
  std::vector<std::string> spots;
  for (const PlaceRef& place : tied_places(object)) spots.push_back(in_words(place));
  return fmt::format("{}", fmt::join(spots, " or "));
}

/// Those of a name that were seen at a place; what has gone only where all have.
std::vector<const UsualObject*> seen_at_places(const UsualAnswer& answer) {
  std::vector<const UsualObject*> seen, there;
  for (const UsualObject& object : answer.objects) {
    if (object.places.empty()) continue;
    seen.push_back(&object);
    if (object.now.status != ObjectStatus::gone) there.push_back(&object);
  }
  return there.empty() ? seen : there;
}

/// The one place that is usual for each of them.
std::optional<PlaceRef> common_place(const std::vector<const UsualObject*>& objects) {
  std::optional<PlaceRef> common;
  for (const PlaceRef& place : tied_places(*objects.front())) {
    const bool usual = std::ranges::all_of(objects, [&](const UsualObject* object) {
      return std::ranges::count(tied_places(*object), place.id, &PlaceRef::id) > 0;
    });
    if (usual && common) return std::nullopt;
    if (usual) common = place;
  }
  return common;
}

/// The usual place of each of several.
void usual_places(const std::vector<const UsualObject*>& objects, const Names& names,
                  const ReplyContext& context, Reply& reply) {
  std::vector<std::string> list;
  for (const UsualObject* object : objects) {
    const UsualPlace& first = object->places.front();
    reply.objects.push_back(object->now.object.id);
    for (const PlaceRef& place : tied_places(*object))
      if (std::ranges::count(reply.places, place.name) == 0) reply.places.push_back(place.name);
    list.push_back(fmt::format("{}: usually {}", names.subject(object->now.object), usual_spot(*object)));
    reply.evidence.push_back(fmt::format("{}: {} in {}, {:.0f} % of its sightings, last at {}",
                                         names.of(object->now.object), in_words(first.place),
                                         counted(first.sightings, "scene"), 100 * first.share,
                                         context.times.text(first.last.time)));
  }
  reply.text = fmt::format("{}.", fmt::join(list, "; "));
  if (const auto common = common_place(objects)) {
    reply.places = {common->name};
    reply.text = fmt::format("All {} are usually {}.", objects.size(), in_words(*common));
  }
}

/// Whether an object is where it usually is.
void is_as_usual(const UsualObject& object, const std::string& name, Reply& reply) {
  const UsualPlace& usual = object.places.front();
  const std::string share = fmt::format("({:.0f} % of its sightings)", 100 * usual.share);
  if (!replies::is_there(object.now) || !object.now.place) {
    reply.verdict = Verdict::no;
    reply.text = fmt::format("No: {} has gone; it is usually {} {}.", name, in_words(usual.place), share);
    return;
  }
  const bool same = object.now.place->id == usual.place.id;
  reply.verdict = same ? Verdict::yes : Verdict::no;
  reply.places = {object.now.place->name};
  reply.text = fmt::format("{}: {} is {}, {} {}.", same ? "Yes" : "No", name, in_words(*object.now.place),
                           same ? "as usual" : "usually " + in_words(usual.place), share);
}

}  // namespace

void write_reply(const UsualAnswer& answer, const ReplyContext& context, Reply& reply) {
  const Snapshot snapshot(context.store, context.as_of);
  const Names names(snapshot);
  if (context.query.asks != Asks::verdict && answer.objects.size() > 1)
    if (const std::vector<const UsualObject*> several = seen_at_places(answer); several.size() > 1)
      return usual_places(several, names, context, reply);
  const auto best = std::ranges::find_if(answer.objects, [&](const UsualObject& object) {
    return !object.places.empty() || &object == &answer.objects.back();
  });
  const std::string name = bare_subject(best->now.object, names);
  reply.objects = {best->now.object.id};
  if (best->places.empty()) {
    reply.not_known = true;
    reply.text = fmt::format("{} was never seen at a place{}.", name, answer.during.empty() ? "" : " then");
    return;
  }
  if (context.query.asks == Asks::verdict) {
    is_as_usual(*best, name, reply);
  } else {
    const UsualPlace& first = best->places.front();
    reply.places = {first.place.name};
    reply.text = fmt::format("{} is usually {} ({:.0f} % of its sightings{}).", name, usual_spot(*best),
                             100 * first.share, tied_places(*best).size() > 1 ? " each" : "");
    for (const PlaceRef& other : tied_places(*best))
      if (std::ranges::count(reply.places, other.name) == 0) reply.places.push_back(other.name);
  }
  for (const UsualPlace& place : best->places)
    reply.evidence.push_back(fmt::format("{}: {}, last at {}", in_words(place.place),
                                         counted(place.sightings, "scene"),
                                         context.times.text(place.last.time)));
}

namespace {

/// Where nobody looked in the period: what was believed to be there at its end.
void believed_contents(const ContentsHistoryAnswer& answer, const ReplyContext& context, Reply& reply) {
  Query query = context.query;
  query.arguments["at"] = query.argument("to").empty() ? "now" : query.argument("to");
  AsOf as_of = context.as_of;
  as_of.at = TimeReader(context.store).read(query.argument("at")).last;
  const ContentsAnswer believed =
      ask(context.store, ContentsQuestion{answer.asked, as_of, query.argument("object")});
  write_reply(believed, ReplyContext{context.store, query, as_of, context.times, context.except}, reply);
}

/// The object that was seen there last.
void seen_there_last(const ContentsHistoryAnswer& answer, const Names& names, const ReplyContext& context,
                     Reply& reply) {
  const PastContent* last = nullptr;
  const PlaceContentsHistory* at = nullptr;
  for (const PlaceContentsHistory& place : answer.places)
    for (const PastContent& object : place.objects)
      if (last == nullptr || object.last.time > last->last.time) {
        last = &object;
        at = &place;
      }
  if (last == nullptr) return;
  reply.objects = {last->now.object.id};
  reply.time = at_once(last->last.time);
  reply.text = fmt::format("{} was seen {} last, at {}.", bare_subject(last->now.object, names),
                           in_words(at->place), context.times.text(last->last.time));
}

/// What was there longest without having been elsewhere in between; what is there still is until the last
/// scene.
void there_longest(const ContentsHistoryAnswer& answer, const Names& names, const ReplyContext& context,
                   Reply& reply) {
  TimeSpan longest = {0, -1};
  std::vector<std::string> list;
  reply.objects.clear();
  for (const PlaceContentsHistory& place : answer.places)
    for (const PastContent& object : place.objects) {
      for (const TimeSpan& span : spans_at(context.store, context.as_of, object, place.place)) {
        const TimeNs more = span.last - span.first - (longest.last - longest.first);
        if (more < 0 || (more == 0 && std::ranges::count(reply.objects, object.now.object.id) > 0)) continue;
        if (more > 0) {
          reply.objects.clear();
          list.clear();
          longest = span;
        }
        reply.objects.push_back(object.now.object.id);
        list.push_back(bare_subject(object.now.object, names));
      }
    }
  reply.time = longest;
  reply.duration = longest.last - longest.first;
  reply.text = fmt::format("{}: {}, {}.", list_in_words(list), duration_text(*reply.duration),
                           context.times.span_text(longest.first, longest.last));
}

/// How long it is since anything was seen there, where nothing is there.
void empty_for(const ContentsHistoryAnswer& answer, const Names& names, const ReplyContext& context,
               const std::string& where, Reply& reply) {
  const auto latest = context.store.latest_scene(context.as_of);
  std::vector<std::string> there;
  for (const PlaceContentsHistory& place : answer.places)
    for (const PastContent& object : place.objects)
      if (object.still_there && is_there(object.now)) there.push_back(bare_subject(object.now.object, names));
  reply.not_known = !latest || reply.objects.empty();
  if (reply.not_known) {
    reply.text = fmt::format("Not known: nothing was ever seen {}.", where);
    return;
  }
  if (!there.empty()) {
    reply.duration = 0;
    reply.text =
        fmt::format("Not now: {} {} {}.", list_in_words(there), there.size() > 1 ? "are" : "is", where);
    return;
  }
  seen_there_last(answer, names, context, reply);
  reply.duration = latest->time - reply.time->first;
  reply.text = fmt::format("At most {}: {}", duration_text(*reply.duration), reply.text);
}

/// How often each place was looked at; of several those that were.
void how_often_looked(const ContentsHistoryAnswer& answer, const ReplyContext& context, Reply& reply) {
  std::vector<std::string> list;
  const PlaceContentsHistory* looked_at = nullptr;
  for (const PlaceContentsHistory& place : answer.places) {
    if (place.looks == 0 && answer.places.size() > 1) continue;
    list.push_back(fmt::format("{} at {}", counted(place.looks, "look"), name_in_words(place.place.name)));
    looked_at = list.size() == 1 ? &place : nullptr;
  }
  if (looked_at != nullptr) reply.number = looked_at->looks;
  const std::string when = looked_at != nullptr && looked_at->last_look
                               ? ", the last at " + context.times.text(looked_at->last_look->time)
                               : "";
  reply.text = list.empty() ? fmt::format("No look at {}.", answer.asked)
                            : fmt::format("{}{}.", list_in_words(list), when);
}

}  // namespace

/// What is there in at least half of the visits at the hours or days asked about.
void usual_contents(const ContentsHistoryAnswer& answer, const ReplyContext& context, Reply& reply) {
  constexpr size_t kMinVisits = 3;  // fewer are not a habit
  const Snapshot snapshot(context.store, context.as_of);
  const Names names(snapshot);
  const auto by_visits = [](const PlaceContentsHistory& place) { return place.visits; };
  const PlaceContentsHistory& place = *std::ranges::max_element(answer.places, {}, by_visits);
  const std::string where = in_words(place.place), visits = counted(place.visits, "look");
  std::vector<std::string> list;
  for (const PastContent& object : place.objects) {
    const std::string name = names.of(object.now.object);
    reply.evidence.push_back(
        fmt::format("{}: in {} of {} ({})", name, object.visits, visits,
                    percent(static_cast<double>(object.visits) / static_cast<double>(place.visits))));
    if (2 * object.visits < place.visits) continue;
    reply.objects.push_back(object.now.object.id);
    list.push_back(name);
  }
  reply.number = list.size();
  reply.not_known = place.visits < kMinVisits;
  if (place.visits == 0)
    reply.text = fmt::format("Not known: no look at {} then.", name_in_words(place.place.name));
  else if (reply.not_known)
    reply.text = fmt::format("Too few to tell, {} {} then: {}.", visits, where, list_in_words(list));
  else
    reply.text = fmt::format("{} usually {} then, in at least half of {}: {}.", list.size(), where, visits,
                             list_in_words(list));
}

void write_reply(const ContentsHistoryAnswer& answer, const ReplyContext& context, Reply& reply) {
  if (context.query.asks == Asks::looks) return how_often_looked(answer, context, reply);
  if (!answer.during.empty()) return usual_contents(answer, context, reply);
  const Snapshot snapshot(context.store, context.as_of);
  const Names names(snapshot);
  std::vector<std::string> list;
  size_t looks = 0;
  for (const PlaceContentsHistory& place : answer.places) {
    looks += place.looks;
    for (const PastContent& object : place.objects) {
      if (std::ranges::count(reply.objects, object.now.object.id) > 0) continue;
      reply.objects.push_back(object.now.object.id);
      list.push_back(names.of(object.now.object));
      reply.evidence.push_back(fmt::format("{}: in {} {}", list.back(), counted(object.sightings, "scene"),
                                           context.times.span_text(object.first.time, object.last.time)));
    }
  }
  const PlaceRef& first = answer.places.front().place;
  if (context.query.asks == Asks::last_time && !reply.objects.empty())
    return seen_there_last(answer, names, context, reply);
  if (context.query.asks == Asks::longest && !reply.objects.empty())
    return there_longest(answer, names, context, reply);
  const std::string where =
      answer.places.size() == 1 ? in_words(first) : (first.container ? "in " : "on ") + answer.asked;
  if (context.query.asks == Asks::duration) return empty_for(answer, names, context, where, reply);
  const std::string seen =
      fmt::format("{} {} seen {}.", list_in_words(list), list.size() > 1 ? "were" : "was", where);
  const Asks asks = context.query.asks;
  reply.not_known = list.empty() && looks == 0;
  if (asks == Asks::exists || asks == Asks::verdict || asks == Asks::empty) {
    reply.not_known = false;
    if (list.empty() && looks == 0) return believed_contents(answer, context, reply);
    const bool is = list.empty() == (asks == Asks::empty);
    reply.verdict = is ? Verdict::yes : Verdict::no;
    reply.text = fmt::format("{}: {}", is ? "Yes" : "No", seen);
  } else if (reply.not_known) {
    reply.text = fmt::format("Not observed: nobody looked {} then.", where);
  } else {
    reply.number = list.size();
    reply.text = asks == Asks::number ? fmt::format("{}: {}", list.size(), seen) : seen;
  }
}

// ---- together, missing, search, tasks

void write_reply(const CoOccurrenceAnswer& answer, const ReplyContext& context, Reply& reply) {
  const Snapshot snapshot(context.store, context.as_of);
  const Names names(snapshot);
  const CoOccurrences& first = answer.objects.front();
  size_t together = 0;
  std::vector<std::string> list;
  for (const CoOccurrence& other : first.others) {
    together = std::max(together, other.together);
    reply.objects.push_back(other.object.id);
    list.push_back(names.of(other.object));
    reply.evidence.push_back(fmt::format("{}: together in {}, {} of the scenes with either", list.back(),
                                         counted(other.together, "scene"), percent(other.share)));
  }
  const std::string name = names.subject(first.object);
  if (context.query.asks == Asks::verdict) reply.verdict = together > 0 ? Verdict::yes : Verdict::no;
  if (context.query.asks == Asks::number) reply.number = together;
  if (together == 0)
    reply.text = fmt::format("{}{} was never seen with {}.", reply.verdict ? "No: " : "", name,
                             answer.other.empty() ? "another object" : part_in_words(answer.other));
  else
    reply.text = fmt::format("{}{} was seen with {}, most often in {}.", reply.verdict ? "Yes: " : "", name,
                             list_in_words(list, 4), counted(together, "scene"));
}

void write_reply(const MissingAnswer& answer, const ReplyContext& context, Reply& reply) {
  const Snapshot snapshot(context.store, context.as_of);
  const Names names(snapshot);
  std::vector<std::string> list, elsewhere;
  size_t visits = 0;
  for (const MissingPlace& place : answer.places) {
    visits += place.visits;
    for (const ExpectedObject& missing : place.missing) {
      // What is missing at one place, and at another, is not missing in the room.
      const std::string name = bare_subject(missing.now.object, names);
      const bool is_missing = !answer.asked.empty() || missing.now.status == ObjectStatus::gone;
      if (is_missing && std::ranges::count(list, name) == 0) list.push_back(name);
      if (is_missing && std::ranges::count(reply.objects, missing.now.object.id) == 0)
        reply.objects.push_back(missing.now.object.id);
      reply.evidence.push_back(fmt::format("{} was {} in {} of {}", names.of(missing.now.object),
                                           in_words(place.place), missing.visits,
                                           counted(place.visits, "visit")));
    }
  }
  if (answer.asked.empty() && visits > 0)
    for (const MisplacedObject& one : misplaced_objects(context.store, context.as_of))
      elsewhere.push_back(bare_subject(one.now.object, names));
  const bool asks_whether = context.query.asks == Asks::exists;
  if (visits == 0) {
    reply.not_known = true;
    reply.text = "Not known: no earlier visit saw anything like this.";
  } else {
    reply.number = list.size();
    if (asks_whether) reply.verdict = list.empty() ? Verdict::no : Verdict::yes;
    if (answer.places.size() == 1 && (list.empty() || !answer.subject.empty()))
      reply.evidence.insert(reply.evidence.begin(), "because " + reason_of(answer.places.front()));
    reply.text =
        fmt::format("{}{} {} missing{}.", asks_whether ? (list.empty() ? "No: " : "Yes: ") : "",
                    list_in_words(list, 4), list.size() > 1 ? "are" : "is",
                    elsewhere.empty() ? "" : "; elsewhere than usual: " + list_in_words(elsewhere, 2));
  }
}

void write_reply(const SearchAnswer& answer, const ReplyContext& context, Reply& reply) {
  const Snapshot snapshot(context.store, context.as_of);
  const Names names(snapshot);
  const ObjectSearch& first = answer.objects.front();
  reply.objects = {first.now.object.id};
  if (first.places.empty()) {
    reply.not_known = true;
    reply.text = fmt::format("No place to search for {} is known.", names.subject(first.now.object));
    return;
  }
  const SearchPlace& best = *std::ranges::max_element(first.places, {}, &SearchPlace::probability);
  if (first.now.status == ObjectStatus::gone && best.probability < kLikely) {
    if (first.now.place) reply.places = {first.now.place->name};
    reply.not_known = true;
    reply.text = fmt::format("No place is likely: {}", gone_text(first.now, names, context.times));
  } else {
    reply.places = {first.places.front().place.name};
    reply.probability = first.places.front().probability;
    reply.text = fmt::format("Look {} first: {} is there with {}.", in_words(first.places.front().place),
                             bare_subject(first.now.object, names), percent(*reply.probability));
  }
  for (const SearchPlace& place : first.places)
    reply.evidence.push_back(
        fmt::format("{}: {} ({})", in_words(place.place), percent(place.probability), place.reason));
}

void write_reply(const SimilarAnswer& answer, const ReplyContext& context, Reply& reply) {
  const Snapshot snapshot(context.store, context.as_of);
  const Names names(snapshot);
  std::vector<std::string> list;
  for (const SimilarObject& similar : answer.objects) {
    reply.objects.push_back(similar.object.object.id);
    list.push_back(names.of(similar.object.object));
    reply.evidence.push_back(fmt::format("{}: {} similar", list.back(), percent(similar.similarity)));
  }
  reply.text = list.empty() ? "No image of another object is stored."
                            : fmt::format("Most similar: {}.", list_in_words(list, 3));
}

void write_reply(const TaskAnswer& answer, const ReplyContext& context, Reply& reply) {
  const Snapshot snapshot(context.store, context.as_of);
  const Names names(snapshot);
  std::vector<std::string> list;
  for (const TaskItem& item : answer.items) {
    reply.objects.push_back(item.object.object.id);
    if (item.object.place) reply.places.push_back(item.object.place->name);
    const std::string name = bare_subject(item.object.object, names);
    const std::string from = item.object.place ? ", " + in_words(*item.object.place) : "";
    if (!item.done)
      list.push_back(item.target ? fmt::format("{} to {}", name, name_in_words(item.target->place.name))
                                 : name + from);
    reply.evidence.push_back(fmt::format(
        "{}{}, {}{}", name, from, percent(item.object.probability),
        item.target ? fmt::format(", to go {} ({})", in_words(item.target->place), item.target->reason)
                    : ""));
  }
  const std::string missing =
      answer.missing.empty() ? "" : fmt::format("{} missing", counted(answer.missing.size(), "fact"));
  reply.text = list.empty()
                   ? fmt::format("Nothing to move{}.", missing.empty() ? "" : "; " + missing)
                   : fmt::format("{}{}.", list_in_words(list, 3), missing.empty() ? "" : "; " + missing);
  for (size_t i = answer.missing.size(); i-- > 0;)
    reply.evidence.insert(reply.evidence.begin(), "missing: " + answer.missing[i]);
}

}  // namespace loci::memory
