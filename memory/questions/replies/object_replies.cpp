// The replies on where an object is and was: `where` and `history`.

#include <fmt/format.h>

#include <algorithm>

#include "memory/questions/events.h"
#include "memory/questions/location.h"
#include "memory/questions/names/names.h"
#include "memory/questions/objects.h"
#include "memory/questions/presence.h"
#include "memory/questions/replies/answer_format.h"
#include "memory/questions/replies/reply_parts.h"

namespace loci::memory {

using namespace format;
using namespace replies;

namespace {

// ---- where

void where_gone(const ObjectBelief& object, const Names& names, const ReplyContext& context, Reply& reply) {
  reply.not_known = true;
  if (object.place) reply.places = {object.place->name};
  reply.text = gone_text(object, names, context.times);
}

/// "The bowl was probably on table_1; it left between 15:00 and 20:30."
void where_one(const ObjectBelief& object, const std::string& spot, const Names& names,
               const ReplyContext& context, const Snapshot& snapshot, Reply& reply) {
  const std::optional<TimeNs> at = context.as_of.at;
  const bool seen_then = at && object.last_seen && *at - object.last_seen->time < kMinute;
  const std::optional<Change> left =
      at && !seen_then ? left_around(object.object.id, *at, snapshot) : std::nullopt;
  reply.probability = object.probability;
  reply.text =
      fmt::format("{} {} {}{}{}.", bare_subject(object.object, names), is_or_was(context),
                  left && object.probability >= kSure ? "probably " : adverb(object.probability), spot,
                  left ? "; it left " + uncapitalised(between_text(bounds_of(*left), context.times)) : "");
}

/// "One is on counter_1 and one probably in drawer_1", "Both are on counter_1".
std::string where_several(const std::vector<const ObjectBelief*>& objects, const ReplyContext& context) {
  struct Spot {
    std::string words;
    size_t count = 0;
    double probability = 1;  ///< of the least probable object there
  };
  std::vector<Spot> spots;
  for (const ObjectBelief* object : objects) {
    const std::string words = spot_in_words(object->place, object->position);
    auto spot = std::ranges::find(spots, words, &Spot::words);
    if (spot == spots.end()) spot = spots.insert(spots.end(), {words});
    ++spot->count;
    spot->probability = std::min(spot->probability, object->probability);
  }
  if (spots.size() == 1)
    return fmt::format("{} {} {}{}", objects.size() == 2 ? "both" : fmt::format("all {}", objects.size()),
                       is_or_was(context, 2), adverb(spots[0].probability), spots[0].words);
  std::vector<std::string> list;
  for (const Spot& spot : spots)
    list.push_back(fmt::format("{} {}{}{}", spot.count == 1 ? "one" : std::to_string(spot.count),
                               list.empty() ? is_or_was(context, spot.count) + std::string(" ") : "",
                               adverb(spot.probability), spot.words));
  return list_in_words(list, 3);
}

void where_place(const WhereAnswer& answer, const std::vector<const ObjectBelief*>& there, const Names& names,
                 const ReplyContext& context, const Snapshot& snapshot, Reply& reply) {
  if (there.empty()) return where_gone(answer.objects.front(), names, context, reply);
  for (const ObjectBelief* object : there)
    if (object->place && std::ranges::count(reply.places, object->place->name) == 0)
      reply.places.push_back(object->place->name);
  const ObjectBelief& first = *there.front();
  if (there.size() > 1)
    reply.text = where_several(there, context) + ".";
  else
    where_one(first, spot_in_words(first.place, first.position), names, context, snapshot, reply);
}

/// Since a time between the last sighting and the look that missed it.
void gone_for(const ObjectBelief& object, const Names& names, const ReplyContext& context,
              const Snapshot& snapshot, Reply& reply) {
  const std::string name = names.subject(object.object);
  reply.objects = {object.object.id};
  const auto latest = context.store.latest_scene(context.as_of);
  std::optional<Change> gone;
  for (const EventRow& event : context.store.events_of(object.object.id, context.as_of))
    if (event.kind == EventKind::gone) gone = snapshot.change(event);
  reply.not_known = !latest || !object.last_seen || !gone;
  if (reply.not_known) {
    reply.text = fmt::format("Not known: when {} left was not observed.", name);
    return;
  }
  reply.duration = latest->time - object.last_seen->time;
  reply.time = TimeSpan{object.last_seen->time, gone->time};
  reply.text = fmt::format("{}: {} was last seen at {}, and not at {}.",
                           bounds_text(latest->time - gone->time, *reply.duration), name,
                           context.times.text(object.last_seen->time), context.times.text(gone->time));
}

void where_time(const WhereAnswer& answer, const Names& names, const ReplyContext& context, Reply& reply) {
  const Asks asks = context.query.asks;
  const ObjectBelief* object = nullptr;  // the one seen last, or first
  for (const ObjectBelief& one : answer.objects) {
    if (!one.last_seen || !one.first_seen) continue;
    const bool better =
        object == nullptr || (asks == Asks::first_time ? one.first_seen->time < object->first_seen->time
                                                       : one.last_seen->time > object->last_seen->time);
    if (better) object = &one;
  }
  if (object == nullptr) {
    reply.not_known = true;
    reply.text = fmt::format("When {} was seen is not known.", names.subject(answer.objects.front().object));
    return;
  }
  const TimeNs time = asks == Asks::first_time ? object->first_seen->time : object->last_seen->time;
  reply.objects = {object->object.id};
  reply.time = at_once(time);
  if (asks == Asks::ago) {
    const auto latest = context.store.latest_scene(context.as_of);
    reply.duration = std::max<TimeNs>(0, (latest ? latest->time : time) - time);
    const std::string ago = duration_text(*reply.duration);
    reply.text = fmt::format("{}{} was seen {}.", ago.empty() ? "Just now" : ago + " ago",
                             ": " + names.subject(object->object), "at " + context.times.text(time));
    return;
  }
  if (asks == Asks::last_time && object->place) reply.places = {object->place->name};
  reply.text =
      fmt::format("At {}: {} was {} seen then{}.", context.times.text(time), names.subject(object->object),
                  asks == Asks::first_time ? "first" : "last",
                  asks == Asks::last_time ? ", " + spot_in_words(object->place, object->position) : "");
}

/// "The cup and the pot": a place where there is one of each; unset = nowhere, or only one name is asked for.
std::optional<PlaceRef> place_of_each(const std::string& names, const std::vector<const ObjectBelief*>& there,
                                      const Snapshot& snapshot) {
  const size_t joint = names.find(" and ");
  if (joint == std::string::npos) return std::nullopt;
  const std::vector<Id> some = snapshot.find_objects(names.substr(0, joint)),
                        others = snapshot.find_objects(names.substr(joint + 5));
  for (const ObjectBelief* one : there)
    for (const ObjectBelief* other : there)
      if (one->object.id != other->object.id && one->place && other->place &&
          one->place->id == other->place->id && std::ranges::count(some, one->object.id) > 0 &&
          std::ranges::count(others, other->object.id) > 0)
        return one->place;
  return std::nullopt;
}

/// Those that have not gone; where some are likely, unlikely ones are left out.
std::vector<const ObjectBelief*> those_there(const WhereAnswer& answer) {
  std::vector<const ObjectBelief*> there;
  for (const ObjectBelief& object : answer.objects)
    if (object.status != ObjectStatus::gone) there.push_back(&object);
  if (std::ranges::any_of(there, [](const ObjectBelief* one) { return is_there(*one); }))
    std::erase_if(there, [](const ObjectBelief* one) { return !is_there(*one); });
  return there;
}

void set_verdict(bool is, const std::string& why, Reply& reply) {
  reply.verdict = is ? Verdict::yes : Verdict::no;
  reply.text = fmt::format("{}: {}", is ? "Yes" : "No", why);
}

/// Whether all are at one place, or one of each name is; `place` says where those are that are `there`.
void where_together(const WhereAnswer& answer, const std::vector<const ObjectBelief*>& there,
                    const Reply& place, const ReplyContext& context, const Snapshot& snapshot, Reply& reply) {
  const std::string object = context.query.argument("object");
  const auto shared = place_of_each(object, there, snapshot);
  const size_t others = answer.objects.size() - there.size();  // that have gone, or whose place is not known
  const auto at = [](const ObjectBelief* one) { return one->place ? one->place->id : Id{0}; };
  const bool at_one = there.size() > 1 &&
                      std::ranges::all_of(there, [&](const auto* one) { return at(one) == at(there[0]); });
  std::string where = place.text;
  if (at_one && others > 0 && where.ends_with('.')) {
    where.pop_back();
    where += fmt::format("; {} of {} {} not.", others, answer.objects.size(), others > 1 ? "are" : "is");
  }
  const bool all = at_one && others == 0;
  set_verdict(all || shared,
              all || !shared ? where : fmt::format("{} are {}.", object, spot_in_words(shared, {})), reply);
  reply.places = place.places;
}

}  // namespace

void write_reply(const WhereAnswer& answer, const ReplyContext& context, Reply& reply) {
  const Snapshot snapshot(context.store, context.as_of);
  const Names names(snapshot);
  const std::vector<const ObjectBelief*> there = those_there(answer);
  const ObjectBelief& first = there.empty() ? answer.objects.front() : *there.front();
  for (const ObjectBelief* object : there) reply.objects.push_back(object->object.id);
  Reply place;
  where_place(answer, there, names, context, snapshot, place);
  switch (context.query.asks) {
    case Asks::exists:
    case Asks::verdict:
      set_verdict(!there.empty(), place.text, reply);
      reply.places = place.places;
      break;
    case Asks::gone:
      set_verdict(there.empty(), place.text, reply);
      break;
    case Asks::duration:
      if (there.empty()) {
        gone_for(first, names, context, snapshot, reply);
      } else {
        reply.duration = 0;
        reply.text = "Not now: " + place.text;
      }
      break;
    case Asks::together:
      where_together(answer, there, place, context, snapshot, reply);
      break;
    case Asks::number:
      reply.number = there.size();
      reply.text = there.empty() ? fmt::format("None: {}", place.text)
                                 : fmt::format("{}: {}", there.size(), place.text);
      break;
    case Asks::first_time:
    case Asks::last_time:
    case Asks::ago:
      where_time(answer, names, context, reply);
      break;
    case Asks::probability:
      reply.probability = first.status == ObjectStatus::gone ? 1 - first.probability : first.probability;
      reply.text =
          first.status == ObjectStatus::gone
              ? fmt::format("{}: {}", percent(*reply.probability), uncapitalised(place.text))
              : fmt::format("{}: {} {} {}.", percent(first.probability), bare_subject(first.object, names),
                            is_or_was(context), spot_in_words(first.place, first.position));
      break;
    case Asks::reason:
      reply.text = reason_of(first, names, context);
      reply.objects = {first.object.id};
      break;
    default:
      place.objects = reply.objects;
      reply = place;
  }
  add_sightings(answer.objects, names, context, reply);
}

namespace {

/// When a stay ended: between the last sighting and the first look that missed the object or saw it
/// elsewhere.
void until_when(const ObjectHistory& history, const Stay& stay, const std::string& name,
                const std::string& spot, const ReplyContext& context, Reply& reply) {
  const TimeNs last = stay.scenes.back().time;
  reply.time = at_once(last);
  const bool still = history.now.place && stay.place && history.now.place->id == stay.place->id &&
                     is_there(history.now) && history.now.last_seen && history.now.last_seen->time == last;
  if (still) {
    reply.text = fmt::format("Still: {} is {}, last seen there at {}.", name, spot, context.times.text(last));
    return;
  }
  const auto ended = std::ranges::find_if(history.changes, [&](const Change& change) {
    return change.time > last && (change.kind == EventKind::gone || change.kind == EventKind::moved);
  });
  const TimeNs missed = ended != history.changes.end() ? ended->time
                        : history.now.last_missed      ? history.now.last_missed->time
                                                       : last;
  reply.time = TimeSpan{last, std::max(last, missed)};
  reply.text = fmt::format("At least until {}: {} was seen {} then{}.", context.times.text(last), name, spot,
                           missed > last ? ", and not at " + context.times.text(missed) : "");
}

/// The last time before a stay at which the object was known not to have come yet.
std::optional<TimeNs> earliest_arrival(const ObjectHistory& history, TimeNs first_seen) {
  for (const Change& change : history.changes)
    if (change.time == first_seen && change.since) return change.since;
  return std::nullopt;
}

/// The last scene, where an object is believed to be where it was seen last and no time was asked about; else
/// the last sighting.
TimeNs believed_until(const ObjectHistory& history, const Stay& stay, const ReplyContext& context) {
  const bool timed = context.query.arguments.contains("from") || context.query.arguments.contains("to");
  const auto latest = context.store.latest_scene(context.as_of);
  const bool still =
      history.now.place && stay.place && history.now.place->id == stay.place->id && is_there(history.now);
  return still && !timed && latest ? latest->time : stay.scenes.back().time;
}

/// Of several objects the one that was seen last; nullptr where none was seen.
const ObjectHistory* seen_last(const HistoryAnswer& answer) {
  const ObjectHistory* last = nullptr;
  for (const ObjectHistory& history : answer.objects)
    if (!history.stays.empty() &&
        (last == nullptr || history.stays.back().scenes.back().time > last->stays.back().scenes.back().time))
      last = &history;
  return last;
}

std::string seen_nowhere(const Query& query, const std::string& name) {
  if (!query.argument("before").empty())
    return fmt::format("Not known: {} was seen nowhere before that.", name);
  if (!query.argument("after").empty())
    return fmt::format("Not known: {} was seen nowhere after that.", name);
  return fmt::format("{} was not seen{} then.", name, query.argument("place").empty() ? "" : " there");
}

/// How long the last stay took, `reply.time`; longer where the object is believed to be there still.
void how_long(const ObjectHistory& history, const Stay& stay, const std::string& name,
              const std::string& spot, const ReplyContext& context, Reply& reply) {
  const auto [from, to] = *reply.time;
  const std::string seen = fmt::format("{} was seen {} {}", name, spot, context.times.span_text(from, to));
  const TimeNs now = believed_until(history, stay, context);
  if (now > to) {
    const std::optional<TimeNs> earliest = earliest_arrival(history, from);
    reply.duration = now - from;
    reply.time = TimeSpan{from, now};
    reply.text =
        fmt::format("{}: {} and is believed to be there still.",
                    bounds_text(now - from, earliest ? std::optional(now - *earliest) : std::nullopt), seen);
    return;
  }
  reply.duration = to - from;
  const std::string lasted = duration_text(to - from);
  reply.text = fmt::format("{}: {}.", lasted.empty() ? "At one time only" : "At least " + lasted, seen);
}

/// All places in order.
void whole_way(const ObjectHistory& history, const std::string& name, Reply& reply) {
  std::vector<std::string> places;
  for (const Stay& one : history.stays) {
    if (one.place && std::ranges::count(reply.places, one.place->name) == 0)
      reply.places.push_back(one.place->name);
    const std::string where = spot_in_words(one.place, one.position);
    if (places.empty() || places.back() != where) places.push_back(where);
  }
  reply.text = fmt::format("{} was {}.", name, list_in_words(places, 4));
}

}  // namespace

void write_reply(const HistoryAnswer& answer, const ReplyContext& context, Reply& reply) {
  const Snapshot snapshot(context.store, context.as_of);
  const Names names(snapshot);
  const ObjectHistory* history = seen_last(answer);
  if (history == nullptr) {
    reply.not_known = true;
    reply.text = seen_nowhere(context.query, names.subject(answer.objects.front().now.object));
    return;
  }
  const Stay& stay = history->stays.back();
  const TimeNs from = spans_of(history->stays).back().first, to = stay.scenes.back().time;
  const std::string name = bare_subject(history->now.object, names),
                    spot = spot_in_words(stay.place, stay.position);
  reply.objects = {history->now.object.id};
  reply.time = TimeSpan{from, to};
  switch (context.query.asks) {
    case Asks::place:
      if (stay.place) reply.places = {stay.place->name};
      reply.text = fmt::format("{} was {} {}.", name, spot, context.times.span_text(from, to));
      break;
    case Asks::until:
      until_when(*history, stay, name, spot, context, reply);
      break;
    case Asks::duration:
      how_long(*history, stay, name, spot, context, reply);
      break;
    case Asks::first_time:
      reply.time = at_once(from);
      reply.text = fmt::format("Since {} at the latest: {} was first seen {} then.", context.times.text(from),
                               name, spot);
      break;
    default:
      whole_way(*history, name, reply);
  }
  for (const Stay& one : history->stays)
    reply.evidence.push_back(fmt::format(
        "{}: {}, {}", spot_in_words(one.place, one.position),
        context.times.span_text(one.scenes.front().time, one.scenes.back().time), scenes_text(one.scenes)));
  if (reply.evidence.size() > kMaxEvidenceLines)
    reply.evidence.erase(reply.evidence.begin(), reply.evidence.end() - kMaxEvidenceLines);
}

}  // namespace loci::memory
