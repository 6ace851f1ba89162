// The replies about objects and places: one sentence for each type of answer that a question can ask for.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
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

/// From this probability on nothing is added.
constexpr double kSure = 0.9;

std::string adverb(double probability) {
  return probability >= kSure ? "" : probability >= kLikely ? "probably " : "perhaps ";
}

// ---- where

void where_gone(const ObjectBelief& object, const Names& names, const ReplyContext& context, Reply& reply) {
  reply.not_known = true;
  if (object.place) reply.places = {object.place->name};
  reply.text = fmt::format("{} has gone", names.subject(object.object));
  if (object.last_seen)
    reply.text += fmt::format("; it was last seen {} at {}", spot_in_words(object.place, object.position),
                              context.times.text(object.last_seen->time));
  reply.text += ".";
}

void where_place(const WhereAnswer& answer, const std::vector<const ObjectBelief*>& there, const Names& names,
                 const ReplyContext& context, Reply& reply) {
  if (there.empty()) return where_gone(answer.objects.front(), names, context, reply);
  const char* verb = is_or_was(context);
  std::vector<std::string> spots;
  for (const ObjectBelief* object : there) {
    const std::string spot = spot_in_words(object->place, object->position);
    if (std::ranges::count(spots, spot) == 0) spots.push_back(spot);
    if (object->place && std::ranges::count(reply.places, object->place->name) == 0)
      reply.places.push_back(object->place->name);
  }
  const ObjectBelief& first = *there.front();
  if (there.size() == 1) {
    reply.text = fmt::format("{} {} {}{}.", bare_subject(first.object, names), verb,
                             adverb(first.probability), spots[0]);
    reply.probability = first.probability;
  } else {
    reply.text = fmt::format("{} objects are '{}': {}.", there.size(), answer.asked, list_in_words(spots, 3));
  }
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
  where_place(answer, there, names, context, place);
  switch (context.query.asks) {
    case Asks::exists:
    case Asks::verdict:
      set_verdict(!there.empty(), place.text);
      reply.places = place.places;
      break;
    case Asks::gone:
      set_verdict(there.empty(), place.text);
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
    reply.text = fmt::format("{} was not seen{} then.", names.subject(answer.objects.front().now.object),
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
    reply.duration = now - from;
    reply.time = TimeSpan{from, now};
    reply.text = fmt::format("{}: {} was seen {} {} and is believed to be there still.",
                             duration_text(now - from), name, spot, context.times.span_text(from, to));
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

/// No where one look shows otherwise; yes where the first and the last look at the place saw it.
Verdict throughout(const WasObject& object) {
  const bool missed = std::ranges::any_of(
      object.views, [](const PlaceView& view) { return view.spot == SpotStatus::seen_empty; });
  if (missed || !object.seen_elsewhere.empty()) return Verdict::no;
  if (object.seen_there.empty() || object.views.empty()) return Verdict::not_observed;
  const bool first = object.before || object.seen_there.front().time <= object.views.front().scene.time;
  const bool last = object.after || object.seen_there.back().time >= object.views.back().scene.time;
  return first && last ? Verdict::yes : Verdict::not_observed;
}

void all_the_time(const WasAnswer& answer, const std::string& name, const std::string& where,
                  const ReplyContext& context, Reply& reply) {
  reply.verdict = Verdict::no;
  const WasObject* best = &answer.objects.front();
  for (const WasObject& one : answer.objects) {
    const Verdict verdict = throughout(one);
    if (verdict == Verdict::no || reply.verdict == Verdict::yes) continue;
    reply.verdict = verdict;
    best = &one;
  }
  const size_t looks = best->seen_there.size();
  if (*reply.verdict == Verdict::yes)
    reply.text =
        fmt::format("Yes: {} was seen {} {}, in {}.", name, where,
                    context.times.span_text(best->seen_there.front().time, best->seen_there.back().time),
                    counted(looks, "look"));
  else if (*reply.verdict == Verdict::no)
    reply.text = fmt::format("No: {} was not {} all the time.", name, where);
  else
    reply.text =
        fmt::format("Not observed all the time: {} was seen {} in {}.", name, where, counted(looks, "look"));
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
  if (asks == Asks::throughout) {
    all_the_time(answer, name, where, context, reply);
  } else if (asks != Asks::verdict) {
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
    reply.text = fmt::format("{}, with {}: {} was {}, seen there at {}{}.", unseen->there ? "Yes" : "No",
                             percent(unseen->probability), name, in_words(unseen->place),
                             context.times.text(unseen->before),
                             unseen->after ? " and " + context.times.text(*unseen->after) : "");
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

}  // namespace

void write_reply(const ObjectsAnswer& answer, const ReplyContext& context, Reply& reply) {
  const Snapshot snapshot(context.store, context.as_of);
  const Names names(snapshot);
  const auto given = [&](const char* name) { return context.query.arguments.contains(name); };
  const bool any_time = given("unseen-since") || given("state") || given("from") || given("to");
  std::vector<ObjectBelief> there;
  for (const ObjectBelief& object : answer.objects)
    if (any_time || is_there(object)) there.push_back(object);
  for (const ObjectBelief& object : there) reply.objects.push_back(object.object.id);
  reply.number = there.size();
  std::vector<std::string> list;
  for (const ObjectBelief& object : there) list.push_back(names.of(object.object));
  const std::string state = context.query.argument("state");
  reply.text = !there.empty() ? fmt::format("{}: {}.", there.size(), list_in_words(list))
               : any_time ? fmt::format("None{}.", state.empty() ? " seen then" : " is known to be " + state)
                          : fmt::format("None now: {} gone.", counted(answer.objects.size(), "object"));
  const Asks asks = context.query.asks;
  if (asks == Asks::summary && !there.empty() && there.size() < answer.objects.size())
    reply.text = fmt::format("{} of {} {} likely where {} seen last: {}.", there.size(),
                             answer.objects.size(), there.size() == 1 ? "is" : "are",
                             there.size() == 1 ? "it was" : "they were", list_in_words(list));
  if (asks == Asks::verdict || asks == Asks::exists) {
    const bool is = there.size() >= std::max<size_t>(1, wanted_count(context.query));
    reply.verdict = is ? Verdict::yes : Verdict::no;
    reply.text = fmt::format("{}: {}", is ? "Yes" : "No", reply.text);
  }
  if (asks == Asks::place && !there.empty()) return by_place(there, names, reply);
  add_sightings(there, names, context, reply);
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
