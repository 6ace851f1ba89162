// The replies about what happened.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <limits>
#include <map>
#include <set>

#include "memory/questions/contents.h"
#include "memory/questions/environment.h"
#include "memory/questions/events.h"
#include "memory/questions/names/names.h"
#include "memory/questions/people.h"
#include "memory/questions/replies/answer_format.h"
#include "memory/questions/replies/reply_parts.h"
#include "memory/questions/routines/digest.h"

namespace loci::memory {

using namespace format;
using namespace replies;

namespace {

/// Whether an object that was gone is where it was before.
bool is_back(const Change& change) {
  return change.place && change.from_place && change.place->id == change.from_place->id;
}

/// "the milk moved from table_1 to counter_1".
std::string happened(const Change& change, const Names& names) {
  if (change.kind == EventKind::joint_changed)
    return fmt::format("{} {}", joint_in_words(change), is_opening(change) ? "opened" : "closed");
  if (change.kind == EventKind::place_moved)
    return fmt::format("{} was moved", change.place ? part_in_words(change.place->name) : "furniture");
  const std::string name = change.object ? bare_subject(*change.object, names) : "an object";
  const auto at = [&](const std::optional<PlaceRef>& place) { return place ? " " + in_words(*place) : ""; };
  switch (change.kind) {
    case EventKind::moved:
      if (change.place && change.from_place && change.place->id != change.from_place->id)
        return fmt::format("{} moved from {} to {}", name, part_in_words(change.from_place->name),
                           part_in_words(change.place->name));
      return fmt::format("{} moved{}", name, at(change.place));
    case EventKind::gone: {
      const auto& from = change.from_place ? change.from_place : change.place;
      return fmt::format("{} has gone{}", name, from ? " from " + part_in_words(from->name) : "");
    }
    case EventKind::appeared:
      return fmt::format("{} appeared{}", name, at(change.place));
    case EventKind::reappeared:
      return fmt::format("{} {}{}", name, is_back(change) ? "came back" : "turned up", at(change.place));
    case EventKind::hidden:
      return fmt::format("{} was hidden{}", name, at(change.place ? change.place : change.from_place));
    default:
      return fmt::format("{} looked different{}", name, at(change.place));
  }
}

/// The object or the part that changed.
std::string changed(const Change& change, const Names& names) {
  return change.object ? without_place(names.of(*change.object)) : joint_in_words(change);
}

// ---- whether a change would have been seen

/// The joints of a part, and of the places of that name; "" = of all parts.
std::set<std::string> joints_asked(const Snapshot& snapshot, const std::string& part) {
  const bool all = part.empty();
  std::set<std::string> joints = all ? std::set<std::string>{} : joints_called(snapshot, part);
  for (const PlaceRow& place : all ? snapshot.places() : snapshot.places_meant(part))
    if (place.joint) joints.insert(*place.joint);
  if (all)
    for (const EnvironmentPart& one : ask(snapshot.store(), OpensQuestion{.as_of = snapshot.as_of()}).parts)
      joints.insert(one.motion->map_joint);
  return joints;
}

/// Why nothing would be known of a change of the joints, unset where looks of the period showed all of them.
std::optional<std::string> unseen_joints(const Snapshot& snapshot, const ReplyContext& context,
                                         const ChangesAnswer& answer, const std::set<std::string>& asked) {
  std::vector<std::string> unseen;
  for (const std::string& joint : asked)
    if (!is_joint_seen(context.store, joint, context.as_of, answer.from, answer.to))
      unseen.push_back(joint_in_words({.joint = snapshot.joint_name(joint)}));
  if (unseen.empty() && !asked.empty()) return std::nullopt;
  const std::string place = context.query.argument("place");
  if (unseen.size() == asked.size() && !place.empty())
    return fmt::format("no look showed whether {} was open", part_in_words(place));
  return unseen.empty() ? "no look showed what opens"
                        : fmt::format("no look showed whether {} {} open{}", list_in_words(unseen),
                                      unseen.size() > 1 ? "were" : "was",
                                      unseen.size() < asked.size() ? "; the others did not change" : "");
}

/// Why nothing would be known of a change that the query asks for; unset where what it is about was seen in
/// the period.
std::optional<std::string> not_watched(const Snapshot& snapshot, const ReplyContext& context,
                                       const ChangesAnswer& answer) {
  const std::vector<SceneRow> scenes = context.store.scenes(context.as_of, answer.from, answer.to);
  if (scenes.empty()) return "nobody looked then";
  const Query& query = context.query;
  const std::string object = query.argument("object"), place = query.argument("place"),
                    kind = query.argument("kind");
  static const std::set<std::string> of_joints = {"opened", "closed", "joint_changed"};
  static const std::set<std::string> of_any = {"", "place_handled"};
  const std::set<std::string> joints =
      object.empty() && (of_joints.contains(kind) || (of_any.contains(kind) && !place.empty()))
          ? joints_asked(snapshot, place)
          : std::set<std::string>{};
  if (of_joints.contains(kind) || !joints.empty()) return unseen_joints(snapshot, context, answer, joints);
  const TimeNs from = answer.from.value_or(scenes.front().time), to = answer.to.value_or(scenes.back().time);
  if (!object.empty()) {
    const std::vector<Id> objects = snapshot.find_objects(object);
    const bool seen = std::ranges::any_of(
        objects, [&](Id id) { return !context.store.observations_of(id, context.as_of, from, to).empty(); });
    if (seen) return std::nullopt;
    return fmt::format("{} was not seen then",
                       bare_subject(snapshot.object_ref(objects.front()), Names(snapshot)));
  }
  if (place.empty()) return std::nullopt;
  const std::vector<PlaceRow> places = snapshot.places_meant(place);
  const bool seen = std::ranges::any_of(places, [&](const PlaceRow& row) {
    return std::ranges::any_of(
        context.store.visibility_of_place(row.id, from, to),
        [](const VisibilityRow& view) { return view.fraction.value_or(0) >= kMinSeenFraction; });
  });
  if (seen) return std::nullopt;
  const bool inside = places.empty() || places.front().container;
  return fmt::format("nobody looked {} {} then", inside ? "into" : "at", part_in_words(place));
}

/// What the changes that were asked for are called: "No move of it is known."
std::string none_text(const Query& query) {
  const std::string kind = query.argument("kind"), place = name_in_words(query.argument("place"));
  if (const std::string times = query.argument("times"); !times.empty())
    return fmt::format("nothing of the kind was seen {} times", times);
  return kind == "opened"   ? (place.empty() ? "nothing was opened" : place + " was not opened")
         : kind == "closed" ? (place.empty() ? "nothing was closed" : place + " was not closed")
         : kind == "handled" || kind == "relocated" ? "no move was seen"
         : kind == "left"                           ? "nothing was seen to leave"
         : kind == "came"                           ? "nothing was seen to come"
                                                    : "no change was seen";
}

/// What is not counted as a move of an object: "; it has gone".
std::string gone_note(const ReplyContext& context, const Snapshot& snapshot) {
  if (context.query.argument("object").empty() || context.query.argument("kind") != "relocated") return "";
  const std::vector<Id> objects = snapshot.find_objects(context.query.argument("object"));
  const bool gone =
      std::ranges::all_of(objects, [&](Id id) { return snapshot.belief(id)->status == ObjectStatus::gone; });
  return gone ? "; it has gone" : "";
}

void not_observed_whether(const Change& change, const std::string& what, const TimeWriter& times,
                          Reply& reply) {
  reply.verdict = Verdict::not_observed;
  reply.text = fmt::format("Not observed whether then: {} between {} and {}.", what,
                           times.text(*change.since), times.text(change.time));
}

void no_changes(const ChangesAnswer& answer, const Snapshot& snapshot, const ReplyContext& context,
                Reply& reply) {
  const std::string text = none_text(context.query);
  if (const std::optional<std::string> why = not_watched(snapshot, context, answer)) {
    if (context.query.asks == Asks::verdict) reply.verdict = Verdict::not_observed;
    reply.not_known = !reply.verdict;
    reply.text = fmt::format("Not observed: {}.", *why);
    return;
  }
  switch (context.query.asks) {
    case Asks::verdict:
      if (!answer.perhaps.empty()) {
        const Change& first = answer.perhaps.front();
        not_observed_whether(first, happened(first, Names(snapshot)), context.times, reply);
        break;
      }
      reply.verdict = Verdict::no;
      reply.text = fmt::format("No: {} then.", text);
      break;
    case Asks::number:
      reply.number = 0;
      reply.text = fmt::format("Never, as far as is known: {}{}.", text, gone_note(context, snapshot));
      break;
    case Asks::objects:
      reply.not_known = true;  // a change can escape every look
      reply.text = fmt::format("None known: {} then.", text);
      break;
    default:
      reply.not_known = true;
      reply.text = fmt::format("Not known: {}.", text);
  }
}

/// From the last opening to the closing after it, or to the last scene; or how long it was closed.
void how_long_open(const ChangesAnswer& answer, bool open, const ReplyContext& context, Reply& reply) {
  const Change *begin = nullptr, *end = nullptr;
  for (const Change& change : answer.changes) {
    if (change.kind != EventKind::joint_changed) continue;
    if (is_opening(change) == open)
      begin = &change, end = nullptr;
    else if (begin != nullptr)
      end = &change;
  }
  if (begin == nullptr) {
    reply.not_known = true;
    reply.text = fmt::format("Not known: it was not seen {}.", open ? "open" : "to close");
    return;
  }
  const auto latest = context.store.latest_scene(context.as_of);
  const TimeNs last = end != nullptr ? end->time : latest ? latest->time : begin->time;
  reply.duration = std::max<TimeNs>(0, last - begin->since.value_or(begin->time));
  reply.time = TimeSpan{begin->time, last};
  const auto at = [&](const Change& change) { return context.times.text(change.time); };
  const TimeNs least = (end != nullptr ? end->since.value_or(begin->time) : last) - begin->time;
  reply.text = fmt::format("{}: {} {} by {} and {}.", bounds_text(least, *reply.duration),
                           joint_in_words(*begin), open ? "opened" : "closed", at(*begin),
                           end == nullptr ? fmt::format("is still {}", open ? "open" : "closed")
                                          : fmt::format("{} by {}", open ? "closed" : "opened", at(*end)));
}

/// The changes of what changed most often.
ChangesAnswer of_most_changed(const ChangesAnswer& all, size_t& times) {
  const auto subject = [](const Change& change) {
    return change.object ? change.object->name : joint_in_words(change);
  };
  std::map<std::string, size_t> counts;
  for (const Change& change : all.changes) times = std::max(times, ++counts[subject(change)]);
  ChangesAnswer most = all;
  std::erase_if(most.changes, [&](const Change& change) { return counts[subject(change)] < times; });
  return most;
}

/// "How many objects were moved?", not "How often was it moved?"
bool counts_objects(const Query& query) {
  static const std::set<std::string> of_objects = {"came", "left", "relocated"},
                                     of_parts = {"opened", "closed"};
  const std::string kind = query.argument("kind");
  return query.argument("object").empty() &&
         (of_objects.contains(kind) || (of_parts.contains(kind) && query.argument("place").empty()));
}

/// The time of the last scene with a person in view from before a change was seen to that moment.
std::optional<TimeNs> person_in_view(const ReplyContext& context, const Change& change) {
  return context.store.last_annotated(kPersonType, change.since.value_or(change.time), change.time,
                                      context.as_of);
}

/// The last change; of several that one look showed, the one whose time is known best.
const Change& last_of(const std::vector<Change>& changes) {
  const auto key = [](const Change& change) {
    return std::pair(change.time, change.since.value_or(std::numeric_limits<TimeNs>::min()));
  };
  const Change* last = &changes.front();
  for (const Change& change : changes)
    if (key(change) >= key(*last)) last = &change;
  return *last;
}

/// A line of evidence for each change, the last ones first, or the first ones where the sentence is about
/// them.
void add_changes(std::vector<Change> changes, const Names& names, const ReplyContext& context, Reply& reply) {
  const Asks asks = context.query.asks;
  if (asks != Asks::earliest && asks != Asks::first_time) std::ranges::reverse(changes);
  for (const Change& change : changes) {
    if (reply.evidence.size() == kMaxEvidenceLines) return;
    reply.evidence.push_back(
        fmt::format("{}: {}{}{}", when_text(change, context.times), happened(change, names),
                    change.probability < 0.995 ? ", " + percent(change.probability) : "",
                    change.scene ? fmt::format(" [{}]", scene_text(*change.scene)) : ""));
  }
}

/// "moved: cup and pot; gone: plate": each object and part under what happened to it.
std::string what_happened(const std::vector<Change>& changes, const Names& names) {
  static const std::map<EventKind, const char*> headings = {
      {EventKind::moved, "moved"},       {EventKind::gone, "gone"},
      {EventKind::appeared, "new"},      {EventKind::reappeared, "came back"},
      {EventKind::hidden, "hidden"},     {EventKind::looks_different, "looks different"},
      {EventKind::place_moved, "moved"}, {EventKind::joint_changed, "opened or closed"}};
  std::vector<std::pair<std::string, std::vector<std::string>>> groups;
  for (auto change = changes.rbegin(); change != changes.rend(); ++change) {
    const std::string heading = headings.at(change->kind),
                      name =
                          change->object ? without_place(names.of(*change->object)) : joint_in_words(*change);
    auto group = std::ranges::find(groups, heading, [](const auto& one) { return one.first; });
    if (group == groups.end()) group = groups.insert(groups.end(), {heading, {}});
    if (std::ranges::count(group->second, name) == 0) group->second.push_back(name);
  }
  std::vector<std::string> said;
  for (const auto& [heading, list] : groups)
    said.push_back(fmt::format("{}: {}", heading, list_in_words(list, 3)));
  return fmt::format("{}", fmt::join(said, "; "));
}

/// The objects and parts that changed, each once, in words; they are those of the reply, too.
std::vector<std::string> mention(const std::vector<Change>& changes, const Names& names, Reply& reply) {
  std::vector<std::string> list;
  for (const Change& change : changes) {
    const std::string name = changed(change, names);
    if (change.object && std::ranges::count(reply.objects, change.object->id) == 0)
      reply.objects.push_back(change.object->id);
    if (std::ranges::count(list, name) > 0) continue;
    list.push_back(name);
    if (!change.object) reply.places.push_back(change.place ? change.place->name : name);
  }
  return list;
}

/// The changes that may be the first of all, or the last: none is known to be earlier, or later.
std::vector<Change> at_one_end(const std::vector<Change>& changes, bool first) {
  std::vector<Change> ends;
  for (const Change& one : changes) {
    const bool surpassed = std::ranges::any_of(changes, [&](const Change& other) {
      const std::partial_ordering order = order_of(bounds_of(other), bounds_of(one));
      return first ? order < 0 : order > 0;
    });
    if (!surpassed) ends.push_back(one);
  }
  return ends;
}

/// Which was the first or the last: several where no look was between them.
void which_at_one_end(const ChangesAnswer& answer, const Names& names, const ReplyContext& context,
                      Reply& reply) {
  const std::vector<Change> ends = at_one_end(answer.changes, context.query.asks == Asks::earliest);
  reply.objects.clear();
  reply.places.clear();
  const std::vector<std::string> list = mention(ends, names, reply);
  if (list.size() == 1) {
    reply.text = fmt::format("{}, by {}.", list.front(), context.times.text(ends.back().time));
    return;
  }
  reply.not_known = true;
  reply.text = shortened(fmt::format("Not observed which: {}, {}.", list_in_words(list, 3),
                                     uncapitalised(between_text(hull_of(ends), context.times))));
}

/// "Between 09:00 and 09:10: the cup was moved."
void when_changed(const Change& change, const Names& names, const TimeWriter& times, Reply& reply) {
  reply.time = TimeSpan{change.since.value_or(change.time), change.time};
  reply.text = fmt::format("{}: {}.", between_text(bounds_of(change), times), happened(change, names));
}

void how_long_ago(const Change& last, const std::string& what, const ReplyContext& context, Reply& reply) {
  const auto latest = context.store.latest_scene(context.as_of);
  reply.duration = std::max<TimeNs>(0, (latest ? latest->time : last.time) - last.time);
  const std::string passed = duration_text(*reply.duration);
  reply.text = fmt::format("{}: {} by {}.", passed.empty() ? "Just now" : passed + " ago", what,
                           context.times.text(last.time));
}

void whether_changed(const ChangesAnswer& answer, const Names& names, const ReplyContext& context,
                     Reply& reply) {
  const Change& last = last_of(answer.changes);
  const std::string what = happened(last, names);
  double none = 1;  // probability that all happened before
  for (const Change& change : answer.changes) none *= answer.from ? share_before(change, *answer.from) : 0;
  if (none <= 0.5) {
    reply.verdict = Verdict::yes;
    reply.text = fmt::format("Yes: {} by {}.", what, context.times.text(last.time));
  } else {
    not_observed_whether(last, what, context.times, reply);
  }
}

void who_did(const Change& last, const std::string& what, const ReplyContext& context, Reply& reply) {
  reply.not_known = true;
  reply.text =
      fmt::format("Not known who: people are not recognised; {} by {}.", what, context.times.text(last.time));
  if (const auto seen = person_in_view(context, last))
    reply.evidence.push_back("somebody was in view at " + context.times.text(*seen));
}

}  // namespace

void write_reply(const ChangesAnswer& all, const ReplyContext& context, Reply& reply) {
  const Snapshot snapshot(context.store, context.as_of);
  const Names names(snapshot);
  size_t most = 0;  // times that one of them changed
  std::optional<ChangesAnswer> most_changed;
  if (context.query.asks == Asks::most) most_changed = of_most_changed(all, most);
  const ChangesAnswer& answer = most_changed ? *most_changed : all;
  if (answer.changes.empty()) return no_changes(answer, snapshot, context, reply);
  const Change& last = last_of(answer.changes);
  const std::vector<std::string> list = mention(answer.changes, names, reply);
  const std::string what = happened(last, names), by = context.times.text(last.time);
  const Asks asks = context.query.asks;
  if (!last.object && last.place && (asks == Asks::verdict || asks == Asks::last_time || asks == Asks::ago))
    reply.places = {last.place->name};
  switch (asks) {
    case Asks::verdict:
      whether_changed(answer, names, context, reply);
      break;
    case Asks::last_time:
      when_changed(last, names, context.times, reply);
      break;
    case Asks::first_time:
      when_changed(answer.changes.front(), names, context.times, reply);
      break;
    case Asks::ago:
      how_long_ago(last, what, context, reply);
      break;
    case Asks::duration:
    case Asks::closed_for:
      how_long_open(answer, asks == Asks::duration, context, reply);
      break;
    case Asks::most:
      reply.text = fmt::format("{}, {}.", list_in_words(list), counted(most, "time"));
      break;
    case Asks::earliest:
    case Asks::latest:
      which_at_one_end(answer, names, context, reply);
      break;
    case Asks::number:
      if (counts_objects(context.query)) {
        reply.number = list.size();
        reply.text = fmt::format("{}: {}.", list.size(), list_in_words(list));
        break;
      }
      reply.number = answer.changes.size();
      reply.text = fmt::format("{}, the last by {}: {}{}.", counted(answer.changes.size(), "time"), by, what,
                               gone_note(context, snapshot));
      break;
    case Asks::objects:
      reply.number = list.size();
      reply.text =
          fmt::format("{}.", context.query.argument("kind").empty() ? what_happened(answer.changes, names)
                                                                    : list_in_words(list));
      break;
    case Asks::place:
      if (last.place) reply.places = {last.place->name};
      reply.time = TimeSpan{last.since.value_or(last.time), last.time};
      reply.text = fmt::format("{}, by {}.", joint_in_words(last), by);
      break;
    case Asks::agent:
      who_did(last, what, context, reply);
      break;
    case Asks::motive:
      reply.not_known = true;
      reply.text = fmt::format("Not known why: no look shows reasons; {} by {}.", what, by);
      break;
    default:
      reply.not_known = last.kind == EventKind::gone;
      reply.text = fmt::format(
          "{} by {}{}.", what, by,
          answer.changes.size() > 1 ? fmt::format(", the last of {} changes", answer.changes.size()) : "");
  }
  add_changes(answer.changes, names, context, reply);
}

void write_reply(const ScenesAnswer& answer, const ReplyContext& context, Reply& reply) {
  reply.number = answer.scenes.size();
  if (answer.scenes.empty()) {
    reply.text = "No scene is known then.";
    return;
  }
  const TimeNs first = answer.scenes.front().scene.time, last = answer.scenes.back().scene.time;
  reply.time = TimeSpan{first, last};
  reply.text =
      fmt::format("{} {}.", counted(answer.scenes.size(), "scene"), context.times.span_text(first, last));
}

void write_reply(const TimelineAnswer& answer, const ReplyContext& context, Reply& reply) {
  const Snapshot snapshot(context.store, context.as_of);
  const Names names(snapshot);
  size_t changes = 0;
  for (const TimelineEntry& entry : answer.entries) changes += entry.changes.size();
  if (answer.entries.empty()) {
    reply.text = "Nothing is known then.";
    return;
  }
  reply.text =
      fmt::format("{} and {} {}.", counted(answer.entries.size(), "scene"), counted(changes, "change"),
                  context.times.span_text(answer.entries.front().scene.scene.time,
                                          answer.entries.back().scene.scene.time));
  for (auto entry = answer.entries.rbegin(); entry != answer.entries.rend(); ++entry)
    for (auto change = entry->changes.rbegin(); change != entry->changes.rend(); ++change)
      if (reply.evidence.size() < kMaxEvidenceLines)
        reply.evidence.push_back(
            fmt::format("{}: {}", context.times.text(change->time), happened(*change, names)));
}

namespace {

/// Which objects are out of their usual place, whether any is, or whether none is.
void out_of_place(const DigestAnswer& answer, const Names& names, Asks asks, Reply& reply) {
  std::vector<std::string> list;
  for (const MisplacedObject& object : answer.misplaced) {
    reply.objects.push_back(object.now.object.id);
    list.push_back(fmt::format("{}, usually {}", names.of(object.now.object), in_words(object.usual)));
  }
  const bool none = list.empty();
  if (asks != Asks::objects) reply.verdict = none == (asks == Asks::all) ? Verdict::yes : Verdict::no;
  const std::string what =
      none ? "everything that is known is in its usual place" : fmt::format("{}", fmt::join(list, "; "));
  const char* head = !reply.verdict ? "" : *reply.verdict == Verdict::yes ? "Yes: " : "No: ";
  reply.text = shortened(fmt::format("{}{}.", head, what));
}

}  // namespace

void write_reply(const DigestAnswer& answer, const ReplyContext& context, Reply& reply) {
  if (answer.scenes == 0) {
    reply.text = fmt::format("Nothing was observed on {}.", answer.day);
    return;
  }
  const Snapshot snapshot(context.store, context.as_of);
  const Names names(snapshot);
  const Asks asks = context.query.asks;
  if (asks == Asks::objects || asks == Asks::exists || asks == Asks::all)
    return out_of_place(answer, names, asks, reply);
  reply.text = fmt::format("{}: {}, {}; {} out of the usual place, {} missing.", answer.day,
                           counted(answer.scenes, "scene"), counted(answer.changes.size(), "change"),
                           counted(answer.misplaced.size(), "object"), answer.missing.size());
  const auto list = [&](const char* heading, const auto& items, const auto& name) {
    constexpr size_t kShown = 6;
    std::vector<std::string> all;
    for (const auto& item : items)
      if (const std::string one = name(item); std::ranges::count(all, one) == 0) all.push_back(one);
    if (!all.empty()) reply.evidence.push_back(fmt::format("{}: {}", heading, list_in_words(all, kShown)));
  };
  list("Changed", answer.changes, [&](const Change& change) {
    return change.object ? names.of(*change.object) : joint_in_words(change);
  });
  list("Out of the usual place", answer.misplaced,
       [&](const MisplacedObject& object) { return names.of(object.now.object); });
  list("Missing", answer.missing, [&](const ObjectBelief& belief) { return names.of(belief.object); });
}

}  // namespace loci::memory
