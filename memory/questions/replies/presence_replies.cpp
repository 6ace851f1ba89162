// The replies on whether an object was at a place: `was`.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>

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

/// When one of them was seen there, from sighting to sighting as long as no look in between excludes it.
std::vector<TimeSpan> spans_there(const WasAnswer& answer) {
  std::vector<TimeSpan> stays;
  for (const WasObject& one : answer.objects)
    for (size_t i = 0; i < one.seen_there.size(); ++i) {
      const TimeNs time = one.seen_there[i].time;
      const bool goes_on = i > 0 && std::ranges::none_of(one.absent, [&](TimeNs absent) {
                             return absent > one.seen_there[i - 1].time && absent < time;
                           });
      if (!goes_on) stays.push_back(at_once(time));
      stays.back().last = time;
    }
  std::ranges::sort(stays, {}, &TimeSpan::first);
  std::vector<TimeSpan> spans;  // those of several objects may overlap
  for (const TimeSpan& stay : stays)
    if (spans.empty() || stay.first > spans.back().last)
      spans.push_back(stay);
    else
      spans.back().last = std::max(spans.back().last, stay.last);
  return spans;
}

/// When one of them was seen there.
void when_seen(const WasAnswer& answer, const std::string& name, const std::string& where,
               const ReplyContext& context, Reply& reply) {
  std::vector<SceneRef> there;
  for (const WasObject& one : answer.objects)
    there.insert(there.end(), one.seen_there.begin(), one.seen_there.end());
  if (there.empty()) {
    reply.not_known = true;
    reply.text = fmt::format("{} was not seen {} then.", name, where);
    return;
  }
  const auto [first, last] = std::ranges::minmax(there, {}, &SceneRef::time);
  if (context.query.asks == Asks::summary) {
    reply.time = TimeSpan{first.time, last.time};
    std::vector<std::string> spans;
    for (const TimeSpan& span : spans_there(answer))
      spans.push_back(context.times.span_text(span.first, span.last));
    reply.text = fmt::format("{}: {} was seen {} then.", list_in_words(spans), name, where);
    return;
  }
  const bool asks_last = context.query.asks == Asks::last_time;
  reply.time = at_once(asks_last ? last.time : first.time);
  reply.text = fmt::format("At {}: {} was {} seen {} then.", context.times.text(reply.time->first), name,
                           asks_last ? "last" : "first", where);
}

/// Whether it was there at a moment at which nobody looked.
void write_unseen(const WasObject& object, TimeNs moment, const std::string& name, const Snapshot& snapshot,
                  const ReplyContext& context, Reply& reply) {
  const UnseenMoment& unseen = *object.unseen;
  reply.verdict = object.verdict;
  reply.probability = object.probability;
  const std::optional<Change> left = left_around(object.object.id, moment, snapshot);
  reply.text = fmt::format(
      "{}: {} was {}, seen there at {}{}.", with_probability(unseen.there, unseen.probability), name,
      in_words(unseen.place), context.times.text(unseen.before),
      unseen.after ? fmt::format(" and {}, with no look in between", context.times.text(*unseen.after))
      : left       ? "; it left by " + context.times.text(left->time)
                   : "");
}

void write_verdict(Verdict verdict, const WasObject& object, const std::string& name,
                   const std::string& where, const ReplyContext& context, Reply& reply) {
  reply.verdict = verdict;
  reply.probability = object.probability;
  if (verdict == Verdict::yes)
    reply.text =
        fmt::format("Yes: {} was {}, seen {}.", name, where,
                    context.times.span_text(object.seen_there.front().time, object.seen_there.back().time));
  else if (verdict == Verdict::no)
    reply.text = fmt::format("No: {} was not {}: {}.", name, where, object.reason);
  else
    reply.text = fmt::format("Not observed: {}.", object.reason);
}

/// Where it was seen instead, and there at other times.
void add_other_sightings(const WasObject& object, const ReplyContext& context, Reply& reply) {
  if (object.before)
    reply.evidence.push_back("before, it was seen there at " + context.times.text(object.before->time));
  if (object.after)
    reply.evidence.push_back("after that, it was seen there at " + context.times.text(object.after->time));
  if (!object.seen_elsewhere.empty())
    reply.evidence.push_back(fmt::format("seen elsewhere: {} at {}",
                                         name_in_words(object.seen_elsewhere.back().second),
                                         context.times.text(object.seen_elsewhere.back().first.time)));
}

}  // namespace

void write_reply(const WasAnswer& answer, const ReplyContext& context, Reply& reply) {
  const Snapshot snapshot(context.store, context.as_of);
  const Names names(snapshot);
  // One that decides, the most probable of them.
  const WasObject& object = *std::ranges::max_element(answer.objects, {}, [&](const WasObject& one) {
    return std::pair(one.verdict == answer.verdict, one.verdict == Verdict::yes ? one.probability : 0);
  });
  const std::string name = bare_subject(object.object, names);
  const std::string where =
      answer.place.empty() ? "seen" : (answer.container ? "in " : "on ") + name_in_words(answer.place);
  reply.objects = {object.object.id};
  switch (context.query.asks) {
    case Asks::together:
      return at_one_time(answer, names, where, context, reply);
    case Asks::throughout:
    case Asks::lasted:
      all_the_time(answer, names, where, context, reply);
      break;
    case Asks::verdict:
    case Asks::reason:
      if (object.unseen)
        write_unseen(object, answer.from, name, snapshot, context, reply);
      else
        write_verdict(answer.verdict, object, name, where, context, reply);
      break;
    default:
      when_seen(answer, name, where, context, reply);
  }
  if (!object.seen_there.empty()) reply.evidence.push_back("seen there in " + scenes_text(object.seen_there));
  if (object.verdict != Verdict::yes && !object.unseen) add_other_sightings(object, context, reply);
}

}  // namespace loci::memory
