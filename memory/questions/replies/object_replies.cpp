// The replies about objects and places: one sentence for each type of answer that a question can ask for.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <set>

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

/// The change by which an object left its place, where that happened between the looks before and after the
/// time asked about.
std::optional<Change> left_around(Id object, TimeNs time, const Snapshot& snapshot) {
  const AsOf known{.at = {}, .known_at = snapshot.as_of().known_at};
  for (const EventRow& event : snapshot.store().events(known, time)) {
    if (event.object != object || (event.kind != EventKind::gone && event.kind != EventKind::moved)) continue;
    const bool around = event.since && *event.since <= time && event.clock.valid_from > time;
    return around ? std::optional(snapshot.change(event)) : std::nullopt;
  }
  return std::nullopt;
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
                  left ? "; it left " + uncapitalised(between_text(*left, context.times)) : "");
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
  for (const EventRow& event : context.store.events(context.as_of))
    if (event.object == object.object.id && event.kind == EventKind::gone) gone = snapshot.change(event);
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

}  // namespace

void write_reply(const WhereAnswer& answer, const ReplyContext& context, Reply& reply) {
  const Snapshot snapshot(context.store, context.as_of);
  const Names names(snapshot);
  std::vector<const ObjectBelief*> there;
  for (const ObjectBelief& object : answer.objects)
    if (object.status != ObjectStatus::gone) there.push_back(&object);
  // Where some are likely, unlikely ones are left out.
  if (std::ranges::any_of(there, [](const ObjectBelief* one) { return is_there(*one); }))
    std::erase_if(there, [](const ObjectBelief* one) { return !is_there(*one); });
  const ObjectBelief& first = there.empty() ? answer.objects.front() : *there.front();
  for (const ObjectBelief* object : there) reply.objects.push_back(object->object.id);
  const auto set_verdict = [&](bool is, const std::string& why) {
    reply.verdict = is ? Verdict::yes : Verdict::no;
    reply.text = fmt::format("{}: {}", is ? "Yes" : "No", why);
  };
  Reply place;
  where_place(answer, there, names, context, snapshot, place);
  switch (context.query.asks) {
    case Asks::exists:
    case Asks::verdict:
      set_verdict(!there.empty(), place.text);
      reply.places = place.places;
      break;
    case Asks::gone:
      set_verdict(there.empty(), place.text);
      break;
    case Asks::duration:
      if (there.empty()) {
        gone_for(first, names, context, snapshot, reply);
      } else {
        reply.duration = 0;
        reply.text = "Not now: " + place.text;
      }
      break;
    case Asks::together: {
      const std::string object = context.query.argument("object");
      const auto shared = place_of_each(object, there, snapshot);
      const bool all = there.size() > 1 && there.size() == answer.objects.size();
      const auto at = [](const ObjectBelief* one) { return one->place ? one->place->id : Id{0}; };
      const bool at_one =
          all && std::ranges::all_of(there, [&](const auto* one) { return at(one) == at(there[0]); });
      set_verdict(at_one || shared, at_one || !shared
                                        ? place.text
                                        : fmt::format("{} are {}.", object, spot_in_words(shared, {})));
      reply.places = place.places;
      break;
    }
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
      reply.probability = first.probability;
      reply.text =
          first.status == ObjectStatus::gone
              ? place.text
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

}  // namespace

void write_reply(const HistoryAnswer& answer, const ReplyContext& context, Reply& reply) {
  const Snapshot snapshot(context.store, context.as_of);
  const Names names(snapshot);
  const ObjectHistory* longest = nullptr;  // of the object seen last
  const Stay* stay = nullptr;
  for (const ObjectHistory& history : answer.objects)
    if (!history.stays.empty() &&
        (stay == nullptr || history.stays.back().scenes.back().time > stay->scenes.back().time)) {
      longest = &history;
      stay = &history.stays.back();
    }
  if (stay == nullptr) {
    reply.not_known = true;
    const std::string name = names.subject(answer.objects.front().now.object);
    reply.text = !context.query.argument("before").empty()
                     ? fmt::format("Not known: {} was seen nowhere before that.", name)
                 : !context.query.argument("after").empty()
                     ? fmt::format("Not known: {} was seen nowhere after that.", name)
                     : fmt::format("{} was not seen{} then.", name,
                                   context.query.argument("place").empty() ? "" : " there");
    return;
  }
  const TimeNs from = spans_of(longest->stays).back().first, to = stay->scenes.back().time;
  const std::string name = bare_subject(longest->now.object, names),
                    spot = spot_in_words(stay->place, stay->position);
  reply.objects = {longest->now.object.id};
  reply.time = TimeSpan{from, to};
  if (context.query.asks == Asks::place) {
    if (stay->place) reply.places = {stay->place->name};
    reply.text = fmt::format("{} was {} {}.", name, spot, context.times.span_text(from, to));
  } else if (context.query.asks == Asks::until) {
    until_when(*longest, *stay, name, spot, context, reply);
  } else if (const TimeNs now = believed_until(*longest, *stay, context);
             context.query.asks == Asks::duration && now > to) {
    const std::optional<TimeNs> earliest = earliest_arrival(*longest, from);
    reply.duration = now - from;
    reply.time = TimeSpan{from, now};
    reply.text =
        fmt::format("{}: {} was seen {} {} and is believed to be there still.",
                    bounds_text(now - from, earliest ? std::optional(now - *earliest) : std::nullopt), name,
                    spot, context.times.span_text(from, to));
  } else if (context.query.asks == Asks::duration) {
    reply.duration = to - from;
    const std::string lasted = duration_text(to - from);
    reply.text =
        fmt::format("{}: {} was seen {} {}.", lasted.empty() ? "At one time only" : "At least " + lasted,
                    name, spot, context.times.span_text(from, to));
  } else if (context.query.asks == Asks::first_time) {
    reply.time = at_once(from);
    reply.text = fmt::format("Since {} at the latest: {} was first seen {} then.", context.times.text(from),
                             name, spot);
  } else {
    std::vector<std::string> places;
    for (const Stay& one : longest->stays) {
      if (one.place && std::ranges::count(reply.places, one.place->name) == 0)
        reply.places.push_back(one.place->name);
      const std::string where = spot_in_words(one.place, one.position);
      if (places.empty() || places.back() != where) places.push_back(where);
    }
    reply.text = fmt::format("{} was {}.", name, list_in_words(places, 4));
  }
  for (const Stay& one : longest->stays)
    reply.evidence.push_back(fmt::format(
        "{}: {}, {}", spot_in_words(one.place, one.position),
        context.times.span_text(one.scenes.front().time, one.scenes.back().time), scenes_text(one.scenes)));
  if (reply.evidence.size() > kMaxEvidenceLines)
    reply.evidence.erase(reply.evidence.begin(), reply.evidence.end() - kMaxEvidenceLines);
}

// ---- was

namespace {

/// The probability that an object was at a place between two sightings there. `believed` is the probability
/// `since` the first of them that it has not left; it leaves and comes back at constant rates (a two-state
/// Markov chain).
double between_sightings(double believed, TimeNs since, TimeNs until) {
  constexpr double kBack = 0.2;  // of the time after it left, it is at that same place again
  if (believed <= kBack || since <= 0) return believed;
  const double stays = std::min(1.0, (believed - kBack) / (1 - kBack));
  const auto back = [](double share) { return kBack + (1 - kBack) * share; };
  const double stays_on = std::pow(stays, static_cast<double>(until) / static_cast<double>(since));
  return back(stays) * back(stays_on) / back(stays * stays_on);
}

/// What the belief says of a moment that no look shows.
struct UnseenMoment {
  const WasObject* object = nullptr;
  PlaceRef place;          ///< where it was
  bool there = false;      ///< that is the place asked about
  double probability = 0;  ///< of that
  TimeNs before = 0;       ///< when it was seen there last before
  std::optional<TimeNs>
      after;  ///< when it was seen there first afterwards, unless it was seen elsewhere first
};

/// Unset where the question is not about a moment, looks decide it, or no place is likely enough.
std::optional<UnseenMoment> unseen_moment(const WasAnswer& answer, const WasObject& object,
                                          const Snapshot& snapshot, const ReplyContext& context) {
  constexpr TimeNs kMoment = 120 * kSecond;
  if (answer.verdict != Verdict::not_observed || answer.place.empty() || answer.to - answer.from > kMoment)
    return std::nullopt;
  const Store& store = context.store;
  const Id id = object.object.id;
  const AsOf known{{}, context.as_of.known_at};
  const auto then = store.belief(id, {answer.from, known.known_at});
  if (!then || !then->place || then->status == ObjectStatus::gone) return std::nullopt;
  const auto before = store.last_observation_before(id, answer.from, {}, known);
  if (!before || before->observation.place != then->place) return std::nullopt;
  const std::vector<PlaceRow> places = snapshot.find_places(answer.place);
  UnseenMoment moment{.object = &object,
                      .place = *snapshot.place_ref(then->place),
                      .there = std::ranges::count(places, *then->place, &PlaceRow::id) > 0,
                      .probability = then->probability,
                      .before = before->time,
                      .after = {}};
  const auto after = store.first_observation_after(id, answer.to, {}, known);
  if (after && after->observation.place == then->place) {
    moment.after = after->time;
    moment.probability =
        between_sightings(then->probability, answer.from - moment.before, after->time - answer.from);
  }
  // Without a sighting afterwards the belief has to be good.
  constexpr double kGood = 0.7;
  return moment.probability >= (moment.after ? kLikely : kGood) ? std::optional(moment) : std::nullopt;
}

/// That one of the objects was there decides, and so does that the only one was elsewhere.
std::optional<UnseenMoment> unseen_moment(const WasAnswer& answer, const Snapshot& snapshot,
                                          const ReplyContext& context) {
  std::optional<UnseenMoment> told;
  for (const WasObject& object : answer.objects) {
    const auto moment = unseen_moment(answer, object, snapshot, context);
    if (moment && (moment->there || answer.objects.size() == 1) &&
        (!told || moment->probability > told->probability))
      told = moment;
  }
  return told;
}

/// Whether an object was there all the time of a period, as looks show it.
struct Lasting {
  Verdict verdict = Verdict::not_observed;
  std::vector<SceneRef> seen = {};          ///< there
  std::optional<TimeNs> absent = {};        ///< a look that excludes that it was there
  std::string elsewhere = {};               ///< "on table_1", where that look saw it elsewhere
  std::optional<TimeNs> elsewhere_to = {};  ///< the last look that saw it there
};

/// Whether the sighting next to a period was at the place, too; where there is none, `otherwise`.
bool goes_on(const std::optional<ObjectObservation>& next, const std::optional<SceneRef>& there,
             bool otherwise) {
  return next ? there && next->association.scene == there->scene : otherwise;
}

/// What there is to say of it from the beginning of its stay on: with an open end its first sighting there,
/// else the first after which it was nowhere else until its last one.
TimeNs begin_of_stay(const WasObject& object, bool open_end) {
  TimeNs begin = object.seen_there.front().time;
  for (const SceneRef& scene : object.seen_there)
    if (!open_end &&
        std::ranges::any_of(object.absent, [&](TimeNs time) { return time > begin && time < scene.time; }))
      begin = scene.time;
  return begin;
}

void set_absence(const WasObject& object, TimeNs begin, Lasting& lasting) {
  const auto absent = std::ranges::find_if(object.absent, [&](TimeNs time) { return time >= begin; });
  if (absent == object.absent.end()) return;
  lasting.absent = *absent;
  lasting.verdict = Verdict::no;
  const std::string* place = nullptr;
  for (const auto& [scene, name] : object.seen_elsewhere) {
    if (scene.time < begin || name.empty()) continue;
    if (place == nullptr) {
      place = &name;
      lasting.elsewhere = name;
      lasting.absent = scene.time;
    }
    if (name == *place) lasting.elsewhere_to = scene.time;
  }
}

/// When it was found to have gone after a sighting, by the end of the period.
std::optional<TimeNs> gone_after(TimeNs sighting, Id object, TimeNs end, const ReplyContext& context) {
  for (const BeliefRow& row : context.store.belief_history(object, {end, context.as_of.known_at}, sighting))
    if (row.status == ObjectStatus::gone && row.clock.valid_from > sighting) return row.clock.valid_from;
  return {};
}

/// No where one look excludes it. Yes where the sightings reach over both ends of the period, or it is
/// believed to be there still.
Lasting lasting_of(const WasAnswer& answer, const WasObject& object, const ReplyContext& context) {
  Lasting lasting{.verdict = object.seen_there.empty() ? object.verdict : Verdict::not_observed};
  const bool open_begin = context.query.asks == Asks::lasted && !object.seen_there.empty();
  const TimeNs begin = open_begin ? begin_of_stay(object, context.query.argument("to").empty()) : answer.from;
  std::ranges::copy_if(object.seen_there, std::back_inserter(lasting.seen),
                       [&](const SceneRef& scene) { return scene.time >= begin; });
  set_absence(object, begin, lasting);
  if (lasting.absent || lasting.seen.empty()) return lasting;
  lasting.absent = gone_after(lasting.seen.back().time, object.object.id, answer.to, context);
  if (lasting.absent) return lasting.verdict = Verdict::no, lasting;
  const Store& store = context.store;
  const Id id = object.object.id;
  const AsOf known{{}, context.as_of.known_at};
  const bool first_look =
      object.views.empty() || object.views.front().scene.time >= lasting.seen.front().time;
  const auto belief = store.belief(id, known);
  const bool there_now = belief && belief->status != ObjectStatus::gone &&
                         belief->status != ObjectStatus::missed && belief->probability >= kLikely;
  const bool from_start =
      open_begin || lasting.seen.front().time <= answer.from ||
      goes_on(store.last_observation_before(id, answer.from, {}, known), object.before, first_look);
  const bool to_end =
      lasting.seen.back().time >= answer.to ||
      goes_on(store.first_observation_after(id, answer.to, {}, known), object.after, there_now);
  if (from_start && to_end) lasting.verdict = Verdict::yes;
  return lasting;
}

/// "it was on table_1 from 08:20 to 15:00", "it was not there at 15:00"
std::string absence_text(const Lasting& lasting, const TimeWriter& times) {
  if (lasting.elsewhere.empty()) return fmt::format("it was not there at {}", times.text(*lasting.absent));
  return fmt::format("it was seen at {} {}", name_in_words(lasting.elsewhere),
                     times.span_text(*lasting.absent, *lasting.elsewhere_to));
}

void all_the_time(const WasAnswer& answer, const Names& names, const std::string& where,
                  const ReplyContext& context, Reply& reply) {
  const WasObject* best = nullptr;
  Lasting lasting;
  const auto rank = [](const Lasting& one) {  // one of several that was there all the time decides
    return std::pair(one.verdict == Verdict::yes            ? 2
                     : one.verdict == Verdict::not_observed ? 1
                                                            : 0,
                     one.seen.size());
  };
  for (const WasObject& one : answer.objects) {
    Lasting other = lasting_of(answer, one, context);
    if (best != nullptr && rank(other) <= rank(lasting)) continue;
    best = &one;
    lasting = std::move(other);
  }
  reply.objects = {best->object.id};
  reply.verdict = lasting.verdict;
  const std::string name = bare_subject(best->object, names);
  const std::string seen =
      lasting.seen.empty()
          ? ""
          : fmt::format("{} was seen {} {}, in {}", name, where,
                        context.times.span_text(lasting.seen.front().time, lasting.seen.back().time),
                        counted(lasting.seen.size(), "look"));
  if (lasting.verdict == Verdict::yes)
    reply.text = fmt::format("Yes: {}.", seen);
  else if (lasting.verdict == Verdict::no)
    reply.text = fmt::format("No: {} was not {} all the time: {}.", name, where,
                             lasting.absent ? absence_text(lasting, context.times) : best->reason);
  else
    reply.text = seen.empty() ? fmt::format("Not observed: {}.", best->reason)
                              : fmt::format("Not observed: {}, not all the time.", seen);
}

using PlaceSpans = std::map<Id, std::vector<TimeSpan>>;  ///< when something was at places

PlaceSpans spans_at_places(const WasAnswer& answer, const std::vector<Id>& objects,
                           const ReplyContext& context) {
  PlaceSpans spans;
  for (const Id object : objects)
    for (const ObjectHistory& history : ask(context.store, HistoryQuestion{.subject = object_name(object),
                                                           .from = answer.from,
                                                           .to = answer.to,
                                                           .as_of = context.as_of,
                                                           .place = answer.place})
                                            .objects)
      for (const Stay& stay : history.stays)
        if (stay.place)
          for (const TimeSpan& span : spans_of({stay}))
            if (const TimeSpan then{std::max(span.first, answer.from), std::min(span.last, answer.to)};
                then.first <= then.last)
              spans[stay.place->id].push_back(then);
  return spans;
}

/// When both were at one place.
PlaceSpans common(const PlaceSpans& some, const PlaceSpans& others) {
  PlaceSpans both;
  for (const auto& [place, spans] : some)
    if (const auto found = others.find(place); found != others.end())
      for (const TimeSpan& one : spans)
        for (const TimeSpan& other : found->second)
          if (const TimeSpan span{std::max(one.first, other.first), std::min(one.last, other.last)};
              span.first <= span.last)
            both[place].push_back(span);
  return both;
}

/// "the cup and the spoon": of each name one of its objects; "the cups": all of them.
std::vector<std::vector<Id>> members_of(const std::string& subject, const Snapshot& snapshot) {
  std::vector<std::vector<Id>> members;
  const std::string joint = " and ";
  for (size_t begin = 0, end = 0; end != std::string::npos; begin = end + joint.size()) {
    end = subject.find(joint, begin);
    members.push_back(
        snapshot.find_objects(subject.substr(begin, end == std::string::npos ? end : end - begin)));
  }
  // "The red cup and the other cups": each object once.
  for (std::vector<Id>& some : members)
    for (const std::vector<Id>& one : members)
      if (one.size() == 1 && some.size() > 1) std::erase(some, one.front());
  if (members.size() > 1) return members;
  std::vector<std::vector<Id>> each;
  for (const Id id : members.front()) each.push_back({id});
  return each;
}

/// Whether they were at one place at one time, by the sightings between which each stayed there. That none
/// shows them together is not observed: looks see a part of the time.
void at_one_time(const WasAnswer& answer, const Names& names, const std::string& where,
                 const ReplyContext& context, Reply& reply) {
  const Snapshot snapshot(context.store, context.as_of);
  std::optional<PlaceSpans> together;
  std::vector<std::string> list, each;
  const auto members = members_of(context.query.argument("object"), snapshot);
  reply.objects.clear();
  for (const std::vector<Id>& one : members) {
    const PlaceSpans spans = spans_at_places(answer, one, context);
    together = together ? common(*together, spans) : spans;
    reply.objects.push_back(one.front());
    list.push_back(bare_subject(snapshot.object_ref(one.front()), names));
    for (const auto& [place, times] : spans)
      each.push_back(fmt::format("{}: {} {}", list.back(), in_words(*snapshot.place_ref(place)),
                                 context.times.span_text(times.front().first, times.back().last)));
  }
  const std::string subject = context.query.argument("object");
  const bool one_name = subject.find(" and ") == std::string::npos;
  const std::string all = one_name && list.size() > 1 ? "the " + subject : list_in_words(list, 4);
  if (members.size() < 2) {
    reply.not_known = true;
    reply.text = fmt::format("Not known: only one such object, {}, is known.", all);
  } else if (!together->empty()) {
    const auto& [place, spans] = *together->begin();
    const PlaceRef at = *snapshot.place_ref(place);
    reply.verdict = Verdict::yes;
    reply.places = {at.name};
    reply.time = spans.front();
    reply.text = fmt::format("Yes: {} were {} together, {}.", all, in_words(at),
                             context.times.span_text(spans.front().first, spans.front().last));
  } else {
    reply.verdict = Verdict::not_observed;
    reply.text = fmt::format("Not observed: {} were never seen {} together.", all,
                             answer.place.empty() ? "at one place" : where);
  }
  for (size_t i = 0; i < std::min(each.size(), kMaxEvidenceLines); ++i) reply.evidence.push_back(each[i]);
}

}  // namespace

void write_reply(const WasAnswer& answer, const ReplyContext& context, Reply& reply) {
  const Snapshot snapshot(context.store, context.as_of);
  const Names names(snapshot);
  const auto of_verdict = std::ranges::find(answer.objects, answer.verdict, &WasObject::verdict);
  const WasObject* best = of_verdict == answer.objects.end() ? &answer.objects.front() : &*of_verdict;
  const std::optional<UnseenMoment> unseen = unseen_moment(answer, snapshot, context);
  if (unseen) best = unseen->object;
  const WasObject& object = *best;
  const std::string name = bare_subject(object.object, names);
  const std::string where =
      answer.place.empty() ? "seen" : (answer.container ? "in " : "on ") + name_in_words(answer.place);
  reply.objects = {object.object.id};
  const Asks asks = context.query.asks;
  if (asks == Asks::together) {
    at_one_time(answer, names, where, context, reply);
    return;
  }
  if (asks == Asks::throughout || asks == Asks::lasted) {
    all_the_time(answer, names, where, context, reply);
  } else if (asks != Asks::verdict && asks != Asks::reason) {
    std::vector<SceneRef> there;
    for (const WasObject& one : answer.objects)
      there.insert(there.end(), one.seen_there.begin(), one.seen_there.end());
    std::ranges::sort(there, {}, &SceneRef::time);
    if (there.empty()) {
      reply.not_known = true;
      reply.text = fmt::format("{} was not seen {} then.", name, where);
    } else {
      const TimeNs first = there.front().time, last = there.back().time;
      reply.time = asks == Asks::last_time    ? at_once(last)
                   : asks == Asks::first_time ? at_once(first)
                                              : TimeSpan{first, last};
      reply.text =
          asks == Asks::summary
              ? fmt::format("{}: {} was seen {} then.", context.times.span_text(first, last), name, where)
              : fmt::format("At {}: {} was {} seen {} then.", context.times.text(reply.time->first), name,
                            asks == Asks::last_time ? "last" : "first", where);
    }
  } else if (unseen) {
    reply.verdict = unseen->there ? Verdict::yes : Verdict::no;
    reply.probability = unseen->there ? unseen->probability : 1 - unseen->probability;
    const std::optional<Change> left = left_around(object.object.id, answer.from, snapshot);
    reply.text = fmt::format("{}: {} was {}, seen there at {}{}.",
                             with_probability(unseen->there, unseen->probability), name,
                             in_words(unseen->place), context.times.text(unseen->before),
                             unseen->after ? " and " + context.times.text(*unseen->after)
                             : left        ? "; it left by " + context.times.text(left->time)
                                           : "");
  } else {
    reply.verdict = answer.verdict;
    reply.probability = object.verdict == Verdict::yes ? 1 : object.probability;
    if (answer.verdict == Verdict::yes)
      reply.text =
          fmt::format("Yes: {} was {}, seen {}.", name, where,
                      context.times.span_text(object.seen_there.front().time, object.seen_there.back().time));
    else if (answer.verdict == Verdict::no)
      reply.text = fmt::format("No: {} was not {}: {}.", name, where, object.reason);
    else
      reply.text = fmt::format("Not observed: {}.", object.reason);
  }
  if (!object.seen_there.empty()) reply.evidence.push_back("seen there in " + scenes_text(object.seen_there));
  if (object.verdict != Verdict::yes && !unseen) {
    if (object.before)
      reply.evidence.push_back("before, it was seen there at " + context.times.text(object.before->time));
    if (object.after)
      reply.evidence.push_back("after that, it was seen there at " + context.times.text(object.after->time));
    if (!object.seen_elsewhere.empty())
      reply.evidence.push_back(fmt::format("seen elsewhere: {} at {}",
                                           name_in_words(object.seen_elsewhere.back().second),
                                           context.times.text(object.seen_elsewhere.back().first.time)));
  }
}

// ---- objects, about

namespace {

/// "On counter_1 5 objects: cup, …": each object at its place.
void by_place(const std::vector<ObjectBelief>& there, const Names& names, Reply& reply) {
  std::vector<std::pair<PlaceRef, std::vector<std::string>>> places;
  for (const ObjectBelief& object : there) {
    if (!object.place) continue;
    auto at = std::ranges::find(places, object.place->id, [](const auto& one) { return one.first.id; });
    if (at == places.end()) at = places.insert(places.end(), {*object.place, {}});
    at->second.push_back(without_place(names.of(object.object)));
  }
  std::ranges::stable_sort(places, std::ranges::greater(), [](const auto& one) { return one.second.size(); });
  std::vector<std::string> counts;
  for (const auto& [place, objects] : places) {
    reply.places.push_back(place.name);
    counts.push_back(fmt::format("{} {}", objects.size(), in_words(place)));
    reply.evidence.push_back(fmt::format("{}: {}", in_words(place), list_in_words(objects, 12)));
  }
  reply.text = fmt::format("{}: {}.", counted(there.size(), "object"), list_in_words(counts, 6));
}

/// Where none is likely there: what has gone has, and the rest may still be there.
std::string none_in_words(const ObjectsAnswer& answer, const Names& names) {
  std::vector<std::string> doubtful;
  for (const ObjectBelief& object : answer.objects)
    if (object.status != ObjectStatus::gone) doubtful.push_back(names.of(object.object));
  return doubtful.empty() ? fmt::format("None now: {} gone.", counted(answer.objects.size(), "object"))
                          : fmt::format("None surely; perhaps {}.", list_in_words(doubtful));
}

/// Whether there is a scene in the period of a query.
bool looked_then(const ReplyContext& context) {
  const TimeReader times(context.store);
  const std::string from = context.query.argument("from"), to = context.query.argument("to");
  const auto first = from.empty() ? std::nullopt : std::optional(times.read(from).first);
  const auto last = to.empty() ? std::nullopt : std::optional(times.read(to).last);
  return !context.store.scenes(context.as_of, first, last).empty();
}

/// Elsewhere than at a place, now or over a period.
std::string elsewhere_in_words(const std::vector<ObjectBelief>& there, const ReplyContext& context,
                               const Snapshot& snapshot, const std::string& list) {
  const std::string name = context.query.argument("not-at");
  const std::string place =
      (snapshot.find_places(name).front().container ? "in " : "on ") + name_in_words(name);
  const bool over = !context.query.argument("from").empty() || !context.query.argument("to").empty();
  if (there.empty()) return fmt::format("None that is known{}.", over ? ": each was seen there" : "");
  return fmt::format("{} {} {}: {}.", there.size(), over ? "not seen" : "not", place, list);
}

/// What the last look at its place missed has perhaps gone.
std::string missed_in_words(const std::vector<ObjectBelief>& missed, bool gone, Asks asks, const Names& names,
                            const std::string& list) {
  return fmt::format("{} {}, not seen at the last look.", gone ? "Perhaps" : "Probably",
                     asks == Asks::objects && missed.size() == 1
                         ? names.subject(missed[0].object)
                         : fmt::format("{}: {}", missed.size(), list));
}

}  // namespace

void write_reply(const ObjectsAnswer& answer, const ReplyContext& context, Reply& reply) {
  const Snapshot snapshot(context.store, context.as_of);
  const Names names(snapshot);
  const auto given = [&](const char* name) { return context.query.arguments.contains(name); };
  const bool in_period = given("from") || given("to");
  const bool any_time = given("unseen-since") || given("state") || in_period;
  const std::string state = context.query.argument("state");
  const bool gone = state == "gone";
  std::vector<ObjectBelief> there, missed;
  for (const ObjectBelief& object : answer.objects)
    if (object.status == ObjectStatus::missed && (gone || (!any_time && object.probability >= kLikely)))
      missed.push_back(object);
    else if (any_time || is_there(object))
      there.push_back(object);
  for (const auto* list : {&there, &missed})
    if (gone || list == &there || there.empty())
      for (const ObjectBelief& object : *list) reply.objects.push_back(object.object.id);
  const auto names_in = [&](const std::vector<ObjectBelief>& objects) {
    std::vector<std::string> list;
    for (const ObjectBelief& object : objects) list.push_back(names.of(object.object));
    return list_in_words(list);
  };
  const Asks asks = context.query.asks;
  reply.number = there.size();
  reply.not_known = there.empty() && missed.empty() && in_period && !looked_then(context);
  if (reply.not_known) {
    reply.text = "Not observed: nobody looked then.";
  } else if (given("not-at")) {
    reply.text = elsewhere_in_words(there, context, snapshot, names_in(there));
  } else if (!there.empty()) {
    reply.text = asks == Asks::objects && there.size() == 1 && missed.empty()
                     ? names.subject(there[0].object) + "."
                     : fmt::format("{}: {}{}.", there.size(), names_in(there),
                                   gone && !missed.empty() ? "; perhaps also " + names_in(missed) : "");
  } else if (!missed.empty()) {
    reply.number = gone ? 0 : missed.size();
    reply.probability = missed.front().probability;
    reply.text = missed_in_words(missed, gone, asks, names, names_in(missed));
  } else {
    reply.text = any_time ? fmt::format("None{}.", state.empty() ? " seen then" : " is known to be " + state)
                          : none_in_words(answer, names);
  }
  if (asks == Asks::summary && !there.empty() && there.size() < answer.objects.size())
    reply.text = fmt::format("{} of {} {} likely where {} seen last: {}.", there.size(),
                             answer.objects.size(), there.size() == 1 ? "is" : "are",
                             there.size() == 1 ? "it was" : "they were", names_in(there));
  if ((asks == Asks::verdict || asks == Asks::exists) && !reply.not_known) {
    const size_t wanted = std::max<size_t>(1, wanted_count(context.query));
    reply.verdict = there.size() >= wanted                   ? Verdict::yes
                    : there.size() + missed.size() >= wanted ? Verdict::not_observed
                                                             : Verdict::no;
    reply.text = fmt::format("{}: {}",
                             *reply.verdict == Verdict::yes  ? "Yes"
                             : *reply.verdict == Verdict::no ? "No"
                                                             : "Not observed",
                             uncapitalised(reply.text));
  }
  if (asks == Asks::place && !there.empty()) return by_place(there, names, reply);
  add_sightings(there.empty() ? missed : there, names, context, reply);
}

namespace {

/// Whether extents are equal but for what the view changes.
bool are_of_one_size(Vector3d a, Vector3d b) {
  constexpr double kViewRatio = 1.3;
  std::ranges::sort(a);
  std::ranges::sort(b);
  return (a.array() <= kViewRatio * b.array()).all() && (b.array() <= kViewRatio * a.array()).all();
}

/// "is red", "measures 6 x 4 x 25 cm"; unset where it is not known.
std::optional<std::string> look_in_words(const ObjectRef& object, const std::string& property) {
  if (property == "colour" && object.color) return "is " + *object.color;
  if (property == "size" && object.size) return "measures " + size_text(*object.size);
  return {};
}

/// The colours or sizes of several objects, and whether they are the same.
void compare_looks(const std::vector<AboutObject>& objects, const std::string& property,
                   const ReplyContext& context, const Names& names, Reply& reply) {
  std::vector<std::string> list;
  std::vector<ObjectBelief> beliefs;
  const ObjectRef& first = objects.front().now.object;
  bool same = true;
  for (const AboutObject& one : objects) {
    const ObjectRef& object = one.now.object;
    reply.objects.push_back(object.id);
    beliefs.push_back(one.now);
    const std::optional<std::string> look = look_in_words(object, property);
    if (!look) continue;
    list.push_back(fmt::format("{} {}", names.subject(object), *look));
    if (property == "colour") same = same && object.color == first.color;
    if (property == "size") same = same && first.size && are_of_one_size(*object.size, *first.size);
  }
  reply.not_known = list.empty();
  reply.text = list.empty() ? "Not known." : list_in_words(list, 4) + ".";
  if (context.query.asks == Asks::together && list.size() == objects.size()) {
    reply.verdict = same ? Verdict::yes : Verdict::no;
    reply.text = fmt::format("{}: {}", same ? "Yes" : "No", reply.text);
  }
  add_sightings(beliefs, names, context, reply);
}

/// How often each of several was seen.
void all_sightings(const AboutAnswer& answer, const Names& names, const ReplyContext& context, Reply& reply) {
  std::vector<std::string> list;
  std::vector<ObjectBelief> beliefs;
  for (const AboutObject& one : answer.objects) {
    reply.objects.push_back(one.now.object.id);
    beliefs.push_back(one.now);
    list.push_back(
        fmt::format("{} in {}", names.subject(one.now.object), counted(one.now.sightings, "scene")));
  }
  reply.text = fmt::format("Seen: {}.", list_in_words(list, 3));
  add_sightings(beliefs, names, context, reply);
}

/// Whether all of them have the colour that is asked about, or whether their colours differ. What has gone
/// counts only where all have.
void judge_colour(const AboutAnswer& answer, const ReplyContext& context, const Names& names, Reply& reply) {
  std::vector<AboutObject> there;
  std::ranges::copy_if(answer.objects, std::back_inserter(there),
                       [](const AboutObject& one) { return one.now.status != ObjectStatus::gone; });
  const std::vector<AboutObject>& objects = there.empty() ? answer.objects : there;
  std::set<std::string> colours;
  bool known = true;
  for (const AboutObject& one : objects) {
    known = known && one.now.object.color;
    colours.insert(lower_case(one.now.object.color.value_or("")));
  }
  compare_looks(objects, "colour", context, names, reply);
  const std::string value = context.query.argument("value");
  const bool is = value == "different"
                      ? colours.size() > 1
                      : colours.size() == 1 && colours.contains(value == "gray" ? "grey" : value);
  reply.not_known = !known;
  reply.verdict = !known ? Verdict::not_observed : is ? Verdict::yes : Verdict::no;
  reply.text = fmt::format("{}: {}", !known ? "Not known" : is ? "Yes" : "No", reply.text);
}

}  // namespace

void write_reply(const AboutAnswer& answer, const ReplyContext& context, Reply& reply) {
  const Snapshot snapshot(context.store, context.as_of);
  const Names names(snapshot);
  if (context.query.arguments.contains("value")) return judge_colour(answer, context, names, reply);
  const AboutObject& first = answer.objects.front();
  const ObjectRef& object = first.now.object;
  const std::string property = context.query.argument("property"), name = names.subject(object);
  if ((property == "colour" || property == "size") && answer.objects.size() > 1)
    return compare_looks(answer.objects, property, context, names, reply);
  if (property == "sightings" && answer.objects.size() > 1)
    return all_sightings(answer, names, context, reply);
  reply.objects = {object.id};
  if (property == "owner") {
    const auto owner = std::ranges::find(first.facts, "owner", &Fact::key);
    reply.not_known = owner == first.facts.end();
    reply.text = reply.not_known ? fmt::format("Not known: nobody stated who owns {}.", name)
                                 : fmt::format("{} owns {}.", owner->value, name);
  } else if (const std::optional<std::string> look = look_in_words(object, property)) {
    reply.text = fmt::format("{} {}.", name, *look);
  } else if (property == "sightings") {
    reply.number = first.now.sightings;
    reply.text = fmt::format("{} was seen in {}.", name, counted(first.now.sightings, "scene"));
  } else if (!property.empty()) {
    reply.not_known = true;
    reply.text = fmt::format("The {} of {} is not known.", property, name);
  } else {
    reply.text = fmt::format("{}: {}{}{}.", name, object.color.value_or("colour unknown"),
                             object.size ? ", " + size_text(*object.size) : "",
                             first.now.place ? ", " + in_words(*first.now.place) : "");
  }
  for (const Fact& fact : first.facts)
    reply.evidence.push_back(fmt::format("{}: {} (said by {})", fact.key, fact.value, fact.source));
  add_sightings({first.now}, names, context, reply);
}

}  // namespace loci::memory
