// The replies about places: what is there and near it.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>

#include "memory/questions/contents.h"
#include "memory/questions/environment_parts.h"
#include "memory/questions/location.h"
#include "memory/questions/names/names.h"
#include "memory/questions/near.h"
#include "memory/questions/replies/answer_format.h"
#include "memory/questions/replies/reply_parts.h"
#include "memory/questions/visits.h"

namespace loci::memory {

using namespace format;
using namespace replies;

namespace {

// ---- on, in

/// "cup and pot" as "cup", "pot".
std::vector<std::string> names_joined_in(const std::string& text) {
  std::vector<std::string> names;
  bool begins = true;
  for (const std::string& word : words_of(text)) {
    const bool joint = word == "and" || word == "or";
    if (!joint && begins) names.push_back(word);
    if (!joint && !begins) names.back() += " " + word;
    begins = joint;
  }
  return names;
}

/// Whether a look within the minute that is asked about showed it, although the last one of it did not.
bool was_seen_then(const ObjectBelief& object, const ReplyContext& context) {
  const std::string at = context.query.argument("at");
  return !at.empty() && at != "now" && context.as_of.at && object.last_seen &&
         *context.as_of.at - object.last_seen->time < kMinute;
}

/// What is believed to be there, over all places asked about.
struct Contents {
  std::vector<ObjectBelief> sure, perhaps;
  std::string where;                         ///< "on table_1"
  const PlaceContents* seen_last = nullptr;  ///< the place viewed last; unset = none was viewed
};

Contents all_contents(const ContentsAnswer& answer, const ReplyContext& context) {
  Contents contents;
  std::vector<Id> except = context.except;
  const Snapshot snapshot(context.store, context.as_of);
  for (const std::string& left_out : names_joined_in(context.query.argument("except")))
    for (const Id id : snapshot.find_objects(left_out)) except.push_back(id);
  std::vector<std::string> places;
  for (const PlaceContents& place : answer.places) {
    for (const ObjectBelief& object : place.there)
      if (std::ranges::count(except, object.object.id) == 0)
        (is_there(object) || was_seen_then(object, context) ? contents.sure : contents.perhaps)
            .push_back(object);
    if (answer.places.size() == 1 || !place.there.empty()) places.push_back(in_words(place.place));
    if (place.last_view &&
        (contents.seen_last == nullptr || place.last_view->time > contents.seen_last->last_view->time))
      contents.seen_last = &place;
  }
  contents.where = places.empty() ? (answer.places.front().place.container ? "in " : "on ") + answer.asked
                                  : list_in_words(places, 3);
  return contents;
}

/// With articles where there are few. The place is named by the sentence.
std::vector<std::string> names_of(const std::vector<ObjectBelief>& objects, const Names& names) {
  std::vector<std::string> list;
  for (const ObjectBelief& object : objects) {
    const std::string name = bare_subject(object.object, names);
    list.push_back(objects.size() > 3 && name.starts_with("the ") ? name.substr(4) : name);
  }
  return list;
}

/// Yes, no where all was looked at and hardly anything can be there, else not observed.
Verdict verdict_of(const ContentsAnswer& answer, const Contents& contents) {
  constexpr double kHardly = 0.2;
  if (!contents.sure.empty()) return Verdict::yes;
  const bool seen = std::ranges::all_of(answer.places, [](const PlaceContents& place) {
    return place.fraction.value_or(0) >= kMinSeenFraction;
  });
  const bool none = std::ranges::all_of(
      contents.perhaps, [](const ObjectBelief& object) { return object.probability < kHardly; });
  return seen && none ? Verdict::no : Verdict::not_observed;
}

std::string not_observed_text(const ContentsAnswer& answer, const Contents& contents,
                              const ReplyContext& context) {
  if (contents.seen_last == nullptr)
    return fmt::format("Not observed: nobody looked {} yet.", contents.where);
  const PlaceContents& place = *contents.seen_last;
  return fmt::format("Not observed: {:.0f} % of {} was seen at {}{}.", 100 * place.fraction.value_or(0),
                     name_in_words(place.place.name), context.times.text(place.last_view->time),
                     answer.places.size() > 1 ? ", and not all of the others" : "");
}

constexpr double kCertain = 0.8;  ///< probability from which on an object that was missed is said to be there

/// Where the objects that were asked about are instead, when that is certain.
std::optional<std::string> elsewhere(const ContentsAnswer& answer, const Snapshot& snapshot,
                                     const Names& names, Reply& reply) {
  std::optional<std::string> text;
  for (const Id id : snapshot.find_objects(answer.subject)) {
    const ObjectBelief object = snapshot.object_belief(id);
    if (object.status == ObjectStatus::gone) {
      if (!text)
        text = fmt::format("{} has gone from {}", names.subject(object.object),
                           object.place ? name_in_words(object.place->name) : "there");
      continue;
    }
    const bool here = std::ranges::any_of(answer.places, [&](const PlaceContents& place) {
      return object.place && place.place.id == object.place->id;
    });
    if (here || object.probability < kCertain) return std::nullopt;
    if (reply.objects.empty())
      text = fmt::format("{} is {}", bare_subject(object.object, names),
                         spot_in_words(object.place, object.position));
    reply.objects.push_back(id);
  }
  return text;
}

/// The probability that one of the objects asked about is there, although none is believed to be.
double doubted_chance(const ContentsAnswer& answer, const Snapshot& snapshot) {
  double chance = 0;
  for (const Id id : snapshot.find_objects(answer.subject))
    for (const PlaceContents& place : answer.places)
      if (const BeliefRow* belief = snapshot.belief(id); belief != nullptr && belief->place == place.place.id)
        chance = std::max(chance, belief->probability);
  return chance;
}

/// Whether the sentence asks about each of them: "both cups", "the cups".
bool means_all(const ContentsAnswer& answer, const ReplyContext& context) {
  const bool plural = !answer.subject.empty() && is_plural(words_of(answer.subject).back());
  return context.query.asks == Asks::all ||
         (context.query.asks == Asks::verdict && plural && wanted_count(context.query) == 0);
}

/// What the name means and has not gone; of "the cups" those that are likely where they are believed to be.
std::vector<ObjectBelief> all_meant(const ContentsAnswer& answer, const ReplyContext& context,
                                    const Snapshot& snapshot) {
  std::vector<ObjectBelief> all;
  for (const Id id : snapshot.find_objects(answer.subject)) {
    const ObjectBelief object = snapshot.object_belief(id);
    if (context.query.asks == Asks::all ? object.status != ObjectStatus::gone : is_there(object))
      all.push_back(object);
  }
  return all;
}

/// Whether all objects that were asked about are there ("both cups"), or nothing else ("only the milk").
Verdict quantified(const ContentsAnswer& answer, const Contents& contents, const Snapshot& snapshot,
                   const ReplyContext& context) {
  std::set<Id> there;
  for (const ObjectBelief& object : contents.sure) there.insert(object.object.id);
  if (there.empty()) return verdict_of(answer, contents);
  std::set<Id> wanted;
  if (context.query.asks != Asks::only) {
    for (const ObjectBelief& object : all_meant(answer, context, snapshot)) wanted.insert(object.object.id);
  } else {
    const ContentsAnswer everything = ask(context.store, ContentsQuestion{answer.asked, context.as_of});
    for (const ObjectBelief& object : all_contents(everything, context).sure) wanted.insert(object.object.id);
  }
  return wanted == there ? Verdict::yes : Verdict::no;
}

void contents_verdict(const ContentsAnswer& answer, const Contents& contents, const Snapshot& snapshot,
                      const Names& names, const ReplyContext& context, Reply& reply) {
  const Asks asks = context.query.asks;
  const bool all = means_all(answer, context), quantifies = all || asks == Asks::only;
  Verdict verdict =
      quantifies ? quantified(answer, contents, snapshot, context) : verdict_of(answer, contents);
  if (verdict == Verdict::yes && contents.sure.size() < wanted_count(context.query)) verdict = Verdict::no;
  std::string why;
  if (!contents.sure.empty()) {
    const std::vector<std::string> list = names_of(contents.sure, names);
    why = fmt::format("{} {} {}", list_in_words(list), is_or_was(context, list.size()), contents.where);
    for (const ObjectBelief& other : all ? all_meant(answer, context, snapshot) : std::vector<ObjectBelief>{})
      if (std::ranges::count(contents.sure, other.object.id, [](const auto& one) { return one.object.id; }) ==
          0)
        why += fmt::format("; {} {} not", names.subject(other.object), is_or_was(context));
  } else if (asks == Asks::verdict || (asks == Asks::empty && !answer.subject.empty())) {
    if (const auto other = elsewhere(answer, snapshot, names, reply)) {
      verdict = Verdict::no;
      why = *other;
    }
  }
  const bool asks_whether =
      (asks == Asks::verdict || asks == Asks::exists) && !answer.subject.empty();  // it is there
  // Missed by the last look only.
  const bool missed = contents.sure.empty() && !contents.perhaps.empty() && asks_whether &&
                      contents.perhaps.front().probability >= kLikely;
  if (verdict == Verdict::not_observed && missed) {
    const ObjectBelief& object = contents.perhaps.front();
    const bool certain = object.probability >= kCertain;
    if (certain)
      reply.verdict = Verdict::yes;
    else
      reply.verdict = Verdict::not_observed;
    reply.probability = object.probability;
    reply.text =
        fmt::format("{}: {} {} {}{}, but was not seen at the last look.",
                    certain ? with_probability(true, object.probability) : "Not observed",
                    bare_subject(object.object, names), is_or_was(context),
                    certain ? "" : adverb(object.probability), spot_in_words(object.place, object.position));
    return;
  }
  if (verdict == Verdict::not_observed) {
    reply.verdict = verdict;
    reply.text = not_observed_text(answer, contents, context);
    return;
  }
  if (why.empty())
    why = fmt::format("{} {} {}", answer.subject.empty() ? "nothing" : "no " + answer.subject,
                      is_or_was(context), contents.where);
  if (asks == Asks::empty) verdict = verdict == Verdict::yes ? Verdict::no : Verdict::yes;
  reply.verdict = verdict;
  const bool believed = verdict == Verdict::yes && asks_whether && !contents.sure.empty();
  const double probability = believed ? contents.sure.front().probability : 1;
  reply.text = fmt::format("{}: {}.", with_probability(verdict == Verdict::yes, probability), why);
}

/// Why an object is not there, if it is not.
void why_not_there(const ContentsAnswer& answer, const Contents& contents, const Snapshot& snapshot,
                   const Names& names, const ReplyContext& context, Reply& reply) {
  const std::vector<ObjectBelief>& there = contents.sure.empty() ? contents.perhaps : contents.sure;
  const Id asked = there.empty() ? snapshot.find_objects(answer.subject).front() : there.front().object.id;
  const ObjectBelief object = snapshot.object_belief(asked);
  reply.objects = {asked};
  reply.text = there.empty() || object.probability < kLikely
                   ? reason_of(object, names, context)
                   : fmt::format("But {} is {}{}.", bare_subject(object.object, names),
                                 adverb(object.probability), spot_in_words(object.place, object.position));
}

/// When the places were looked at last: at least half of one of them, or the little that was seen of it.
void write_last_look(const ContentsAnswer& answer, const Contents& contents, const ReplyContext& context,
                     Reply& reply) {
  const Snapshot snapshot(context.store, context.as_of);
  std::optional<PlaceLook> last;
  std::string place;
  for (const double min_fraction : {kMinSeenFraction, 0.0}) {
    for (const PlaceRow& one : snapshot.find_places(answer.asked))
      if (const auto look = last_look(snapshot, one, min_fraction); look && (!last || look->to > last->to)) {
        last = look;
        place = name_in_words(one.name);
      }
    if (last) break;
  }
  reply.not_known = !last;
  if (!last) {
    reply.text = fmt::format("Nobody looked {} yet.", contents.where);
    return;
  }
  reply.time = at_once(last->to);
  std::string when = "At " + context.times.text(last->to);
  if (context.query.asks == Asks::ago) {
    const auto latest = context.store.latest_scene(context.as_of);
    reply.duration = std::max<TimeNs>(0, (latest ? latest->time : last->to) - last->to);
    const std::string elapsed = duration_text(*reply.duration);
    when = elapsed.empty() ? "Just now" : fmt::format("{} ago, at {}", elapsed, context.times.text(last->to));
  }
  const bool partly = last->fraction && *last->fraction < kMinSeenFraction;
  reply.text = fmt::format("{}: {} was last looked at then{}.", when, place,
                           partly ? fmt::format(", {:.0f} % of it", 100 * *last->fraction) : "");
}

/// What is there, or how many.
void write_list(const ContentsAnswer& answer, const Contents& contents, const std::vector<std::string>& list,
                const ReplyContext& context, Reply& reply) {
  reply.not_known = verdict_of(answer, contents) == Verdict::not_observed;
  if (reply.not_known) {
    reply.text = not_observed_text(answer, contents, context);
    return;
  }
  reply.number = list.size();
  if (list.empty() && !answer.subject.empty() && context.query.asks != Asks::number)
    reply.text = fmt::format("No {} {} {}.", answer.subject, is_or_was(context), contents.where);
  else if (context.query.asks != Asks::number)
    reply.text =
        fmt::format("{} {} {}.", list_in_words(list), is_or_was(context, list.size()), contents.where);
  else if (list.empty())
    reply.text = fmt::format("None {}.", contents.where);
  else
    reply.text = fmt::format("{} {}: {}.", list.size(), contents.where, list_in_words(list));
  if (context.query.asks == Asks::number) {
    const auto missed = std::ranges::count(contents.perhaps, ObjectStatus::missed, &ObjectBelief::status);
    add_out_of_sight(contents.perhaps.size() - static_cast<size_t>(missed), reply);
  }
}

void add_last_look(const PlaceContents& view, const ReplyContext& context, Reply& reply) {
  reply.evidence.push_back(fmt::format(
      "last looked at {} ({}{})", context.times.text(view.last_view->time), scene_text(*view.last_view),
      view.fraction ? fmt::format(", {:.0f} % of it", 100 * *view.fraction) : ""));
}

}  // namespace

void write_reply(const ContentsAnswer& answer, const ReplyContext& context, Reply& reply) {
  const Snapshot snapshot(context.store, context.as_of);
  const Names names(snapshot);
  const Contents contents = all_contents(answer, context);
  for (const ObjectBelief& object : contents.sure) reply.objects.push_back(object.object.id);
  switch (context.query.asks) {
    case Asks::verdict:
    case Asks::exists:
    case Asks::empty:
    case Asks::all:
    case Asks::only:
      contents_verdict(answer, contents, snapshot, names, context, reply);
      if (reply.verdict == Verdict::yes && context.query.asks == Asks::verdict && !contents.sure.empty())
        if (const auto& place = contents.sure.front().place) reply.places = {place->name};
      break;
    case Asks::probability: {
      const std::vector<ObjectBelief>& objects = contents.sure.empty() ? contents.perhaps : contents.sure;
      if (objects.empty()) {
        contents_verdict(answer, contents, snapshot, names, context, reply);
        if (reply.verdict != Verdict::no) break;
        reply.probability = doubted_chance(answer, snapshot);
        if (reply.text.starts_with("No: ")) reply.text.replace(0, 2, percent(*reply.probability));
        break;
      }
      reply.probability = objects.front().probability;
      reply.text = fmt::format("{}: {} is {}.", percent(*reply.probability),
                               bare_subject(objects.front().object, names), contents.where);
      break;
    }
    case Asks::reason:
      if (contents.sure.empty())
        contents_verdict(answer, contents, snapshot, names, context, reply);
      else
        reply.text = reason_of(contents.sure.front(), names, context);
      break;
    case Asks::why_not:
      why_not_there(answer, contents, snapshot, names, context, reply);
      break;
    case Asks::last_time:
    case Asks::ago:
      write_last_look(answer, contents, context, reply);
      break;
    default:
      write_list(answer, contents, names_of(contents.sure, names), context, reply);
  }
  if (contents.seen_last != nullptr) add_last_look(*contents.seen_last, context, reply);
  if (!contents.perhaps.empty())
    reply.evidence.push_back("perhaps also: " + list_in_words(names_of(contents.perhaps, names)));
  if (contents.sure.size() == 1) add_sightings(contents.sure, names, context, reply);
}

namespace {

/// "behind the pot, as seen at 20:30:01".
std::string relation_in_words(const NearAnswer& answer, const std::string& around, const std::string& with,
                              const TimeWriter& times) {
  const auto as_seen = [&](const char* relation) {
    return fmt::format("{} {}{}", relation, around,
                       answer.seen ? ", as seen at " + times.text(answer.seen->time) : "");
  };
  switch (answer.relation) {
    case Relation::near:
      return answer.radius_m < 1 ? fmt::format("within {:.0f} cm of {}", 100 * answer.radius_m, around)
                                 : fmt::format("within {:.1f} m of {}", answer.radius_m, around);
    case Relation::next_to:
      return "next to " + around;
    case Relation::on:
      return "on " + around;
    case Relation::under:
      return "under " + around;
    case Relation::between:
      return fmt::format("between {} and {}", around, with);
    case Relation::left:
      return as_seen("left of");
    case Relation::right:
      return as_seen("right of");
    case Relation::behind:
      return as_seen("behind");
    case Relation::in_front:
      return as_seen("in front of");
  }
  return {};
}

/// What hides its neighbours cannot be said to have none.
void write_hidden(const NearAnswer& answer, const std::string& around, const BeliefRow* object,
                  const Snapshot& snapshot, const ReplyContext& context, Reply& reply) {
  const auto place = object != nullptr ? snapshot.place_ref(object->place) : std::nullopt;
  reply.not_known = true;
  if (answer.relation == Relation::under && place) {
    reply.places = {place->name};
    reply.text = fmt::format("Not seen: {} hides what is under it; it is {}.", around, in_words(*place));
  } else {
    reply.text = fmt::format("Not seen: nothing is known to be {}.",
                             relation_in_words(answer, around, "", context.times));
  }
}

/// Several are called what was asked about, and none has anything there.
bool none_of_several(const NearAnswer& answer, const Snapshot& snapshot) {
  return object_id(answer.around) && answer.objects.empty() && snapshot.find_objects(answer.asked).size() > 1;
}

std::string around_in_words(const NearAnswer& answer, const Snapshot& snapshot, const Names& names) {
  const auto object = object_id(answer.around);
  if (none_of_several(answer, snapshot)) return fmt::format("any '{}'", answer.asked);
  if (object) return names.subject(snapshot.object_ref(*object));
  return answer.around.empty() ? point_text(answer) : answer.around;
}

/// Those that are there, in words; they are the objects and the evidence of the reply, too.
std::vector<std::string> mention(const NearAnswer& answer, const Names& names, const ReplyContext& context,
                                 Reply& reply) {
  std::vector<std::string> list;
  for (const NearObject& near : answer.objects) {
    if (!is_there(near.object) || std::ranges::count(context.except, near.object.object.id) > 0) continue;
    reply.objects.push_back(near.object.object.id);
    list.push_back(names.of(near.object.object));
    reply.evidence.push_back(fmt::format("{:.0f} cm: {}, {}", 100 * near.distance_m, list.back(),
                                         spot_in_words(near.object.place, near.object.position)));
  }
  return list;
}

/// "the cup and the pot are", "the cup is not", "no 'spoon' was".
std::string found_in_words(const std::vector<std::string>& list, const std::string& only,
                           const Snapshot& snapshot, const Names& names, const ReplyContext& context) {
  const std::string be = std::string(" ") + is_or_was(context, list.size());
  if (!list.empty()) return list_in_words(list) + be;
  if (only.empty()) return "nothing" + be;
  const std::vector<Id> asked = snapshot.find_objects(only);
  return asked.size() == 1 ? names.subject(snapshot.object_ref(asked[0])) + be + " not"
                           : fmt::format("no '{}'{}", only, be);
}

/// What is in an object or between objects is not seen; what is on it or near it is.
std::string contents_not_recorded(const NearAnswer& answer, const std::string& around,
                                  const std::vector<std::string>& list) {
  if (answer.relation == Relation::on)
    return fmt::format("Not recorded: what is in {}; on it: {}.", around,
                       list.empty() ? "nothing" : list_in_words(list, 3));
  return fmt::format("Not recorded: what is over or between {}; near it: {}.", around,
                     list_in_words(list, 3));
}

}  // namespace

void write_reply(const NearAnswer& answer, const ReplyContext& context, Reply& reply) {
  const Snapshot snapshot(context.store, context.as_of);
  const Names names(snapshot);
  const auto object = object_id(answer.around), other = object_id(answer.with);
  const std::string around = around_in_words(answer, snapshot, names),
                    with = other ? names.subject(snapshot.object_ref(*other)) : "",
                    only = context.query.argument("object");
  const std::vector<std::string> list = mention(answer, names, context, reply);
  const std::string found = fmt::format("{} {}.", found_in_words(list, only, snapshot, names, context),
                                        relation_in_words(answer, around, with, context.times));
  const BeliefRow* belief = object ? snapshot.belief(*object) : nullptr;
  const bool hides = answer.relation == Relation::under || answer.relation == Relation::behind;
  if (belief != nullptr && belief->status == ObjectStatus::gone && !none_of_several(answer, snapshot)) {
    const bool around_it = answer.relation == Relation::near || answer.relation == Relation::next_to;
    const std::string near = around_it && !list.empty() && only.empty()
                                 ? fmt::format("; where it was: {}", list_in_words(list, 3))
                                 : "";
    reply = {};
    reply.not_known = true;
    reply.text = fmt::format("Not known: {} has gone{}.", around, near);
  } else if (context.query.asks == Asks::agent) {
    reply.not_known = true;
    reply.objects.clear();
    reply.text = contents_not_recorded(answer, around, list);
  } else if (hides && list.empty() && only.empty()) {
    write_hidden(answer, object ? names.subject(snapshot.object_ref(*object)) : around, belief, snapshot,
                 context, reply);
  } else if (context.query.asks == Asks::verdict || context.query.asks == Asks::exists) {
    reply.verdict = list.empty() ? Verdict::no : Verdict::yes;
    reply.text = fmt::format("{}: {}", list.empty() ? "No" : "Yes", found);
  } else if (const bool farthest = context.query.argument("order") == "farthest";
             answer.relation == Relation::near && list.size() == 1 &&
             (farthest || !context.query.argument("count").empty())) {
    reply.text =
        fmt::format("{} is {} {}, {:.0f} cm away.", list[0], farthest ? "farthest from" : "nearest to",
                    around, 100 * answer.objects[0].distance_m);
  } else {
    reply.text = found;
  }
}

}  // namespace loci::memory
