// The replies about the furniture: what there is, where, how large, and what is open.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "memory/questions/contents.h"
#include "memory/questions/environment.h"
#include "memory/questions/events.h"
#include "memory/questions/replies/answer_format.h"
#include "memory/questions/replies/reply_parts.h"
#include "memory/questions/snapshot.h"

namespace loci::memory {

using namespace format;
using namespace replies;

// ---- room

namespace {

/// "counter_1 is at (1.60, 2.70) in the map, 1.4 m from shelf_1": beside the nearest other place.
std::string where_part_is(const EnvironmentPart& part, const RoomAnswer& room) {
  const EnvironmentPart* nearest = nullptr;
  const auto distance = [&](const EnvironmentPart& other) {
    return (*other.position - *part.position).norm();
  };
  for (const EnvironmentPart& other : room.parts)
    if (other.place && other.position && other.name != part.name &&
        (nearest == nullptr || distance(other) < distance(*nearest)))
      nearest = &other;
  std::string text =
      fmt::format("{} is at ({:.2f}, {:.2f}) in the map", part.name, part.position->x(), part.position->y());
  if (nearest != nullptr) text += fmt::format(", {:.1f} m from {}", distance(*nearest), nearest->name);
  return text;
}

/// "table_1 measures 1.20 x 0.80 m and is 0.74 m high"
std::string size_in_words(const EnvironmentPart& part) {
  const auto [depth, width] = std::minmax(part.size->x(), part.size->y());
  const double height = part.motion ? part.size->z() : part.height.value_or(part.size->z());
  return fmt::format("{} measures {:.2f} x {:.2f} m and is {:.2f} m high", part.name, width, depth, height);
}

/// A line for each that `text` has one for.
template <class Text>
void describe_parts(const RoomAnswer& answer, const char* unknown, const Text& text, Reply& reply) {
  std::vector<std::string> list;
  for (const EnvironmentPart& part : answer.parts) {
    reply.places.push_back(part.name);
    if (const std::string line = text(part); !line.empty()) list.push_back(line);
  }
  reply.not_known = list.empty();
  reply.text = list.empty() ? fmt::format("Not known: the map has no {} of it.", unknown)
                            : shortened(fmt::format("{}.", fmt::join(list, "; ")));
}

/// The places with the most objects.
void with_most_objects(const RoomAnswer& answer, Reply& reply) {
  size_t most = 0;
  std::vector<std::string> list;
  for (const EnvironmentPart& part : answer.parts)
    if (part.place) most = std::max(most, part.objects);
  for (const EnvironmentPart& part : answer.parts) {
    if (!part.place || most == 0) continue;
    if (part.objects == most) {
      reply.places.push_back(part.place->name);
      list.push_back(name_in_words(part.place->name));
    }
    reply.evidence.push_back(fmt::format("{}: {}", in_words(*part.place), counted(part.objects, "object")));
  }
  reply.not_known = list.empty();
  reply.text = list.empty() ? "Not known: nothing is known to be at a place."
                            : fmt::format("{}: {}{}.", list_in_words(list), counted(most, "object"),
                                          list.size() > 1 ? " each" : "");
}

}  // namespace

void write_reply(const RoomAnswer& answer, const ReplyContext& context, Reply& reply) {
  if (context.query.asks == Asks::most) return with_most_objects(answer, reply);
  if (context.query.asks == Asks::place) {
    const RoomAnswer room = ask(context.store, RoomQuestion{.as_of = context.as_of});
    return describe_parts(
        answer, "position",
        [&](const EnvironmentPart& part) { return part.position ? where_part_is(part, room) : ""; }, reply);
  }
  if (context.query.asks == Asks::property)
    return describe_parts(
        answer, "size", [](const EnvironmentPart& part) { return part.size ? size_in_words(part) : ""; },
        reply);
  std::vector<std::string> counts, parts;
  for (const auto& [name, count] : answer.classes) counts.push_back(counted(count, name));
  for (const EnvironmentPart& part : answer.parts)
    parts.push_back(joint_in_words({.joint = part.name + "_joint"}));
  reply.number = answer.parts.size();
  if (!answer.state.empty()) {
    for (const EnvironmentPart& part : answer.parts) reply.places.push_back(part.place->name);
    if (context.query.asks == Asks::exists) reply.verdict = answer.parts.empty() ? Verdict::no : Verdict::yes;
    const char* verdict = !reply.verdict ? "" : answer.parts.empty() ? "No: " : "Yes: ";
    reply.text = fmt::format("{}{} {} {}.", verdict, answer.parts.empty() ? "none" : list_in_words(parts),
                             answer.parts.size() > 1 ? "are" : "is", answer.state);
    return;
  }
  if (context.query.asks == Asks::exists) {
    reply.verdict = Verdict::yes;  // what is not there has no such name
    reply.text = fmt::format("Yes: {}.", list_in_words(parts));
    return;
  }
  reply.text = answer.asked.empty() || answer.asked == "room"
                   ? fmt::format("{}.", list_in_words(counts, 8))
                   : fmt::format("{}: {}.", answer.parts.size(), list_in_words(parts));
}

// ---- opens

namespace {

const char* state_name(bool open) {
  return open ? "open" : "closed";
}

/// "open at 17:45"; "" = no look showed it.
std::string state_at(const PartMotion& motion, const std::optional<double>& position,
                     const std::optional<SceneRef>& seen, const TimeWriter& times) {
  if (!position || !seen) return "";
  return fmt::format("{} at {}", state_name(motion.is_open(*position)), times.text(seen->time));
}
std::string last_state(const PartMotion& motion, const TimeWriter& times) {
  return state_at(motion, motion.position, motion.seen, times);
}
std::string next_state(const PartMotion& motion, const TimeWriter& times) {
  return state_at(motion, motion.next_position, motion.next_seen, times);
}

void state_evidence(const std::vector<EnvironmentPart>& parts, const ReplyContext& context, Reply& reply) {
  for (const EnvironmentPart& part : parts) {
    if (!part.motion) continue;
    std::vector<std::string> known;
    for (const std::string& state :
         {last_state(*part.motion, context.times), next_state(*part.motion, context.times)})
      if (!state.empty()) known.push_back(state);
    if (part.motion->opened)
      known.push_back("last opened by " + context.times.text(part.motion->opened->time));
    if (part.motion->closed)
      known.push_back("last closed by " + context.times.text(part.motion->closed->time));
    if (!known.empty()) reply.evidence.push_back(fmt::format("{}: {}", part.name, fmt::join(known, ", ")));
  }
}

/// "Drawer_1 and drawer_2": as people call parts.
std::string list_of(const std::vector<EnvironmentPart>& parts) {
  std::vector<std::string> names;
  for (const EnvironmentPart& part : parts) names.push_back(joint_in_words({.joint = part.name + "_joint"}));
  return list_in_words(names);
}

/// Why it is not known how parts stood at the time asked about.
std::string unknown_state(const std::vector<EnvironmentPart>& parts, const ReplyContext& context) {
  const std::string name = list_of(parts);
  const PartMotion& motion = *parts.front().motion;
  const std::string before = last_state(motion, context.times), after = next_state(motion, context.times);
  if (parts.size() > 1 || before.empty())
    return fmt::format("no look showed whether {} {} open", name, is_or_was(context, parts.size()));
  return fmt::format("{} was {} and {}, and nobody looked in between", name, before, after);
}

void last_opened(const OpensAnswer& answer, const ReplyContext& context, Reply& reply) {
  const EnvironmentPart* last = nullptr;
  for (const EnvironmentPart& part : answer.parts)
    if (part.motion->opened && (last == nullptr || part.motion->opened->time > last->motion->opened->time))
      last = &part;
  reply.not_known = last == nullptr;
  if (last == nullptr) {
    reply.text = fmt::format("'{}' was never seen to open.", answer.asked);
    return;
  }
  const Change& opened = *last->motion->opened;
  reply.time = TimeSpan{opened.since.value_or(opened.time), opened.time};
  reply.text = fmt::format("{}: {} opened.", between_text(bounds_of(opened), context.times), last->name);
}

/// Whether one is open, or all are closed.
void opens_verdict(const OpensAnswer& answer, bool asks_open, const ReplyContext& context, Reply& reply) {
  std::vector<EnvironmentPart> open, closed, unknown;
  for (const EnvironmentPart& part : answer.parts) {
    const std::optional<bool> state = part.motion->open();
    (!state ? unknown : *state ? open : closed).push_back(part);
  }
  if (open.empty() && !unknown.empty()) {
    reply.verdict = Verdict::not_observed;
    reply.text = fmt::format("Not observed: {}.", unknown_state(unknown, context));
    return;
  }
  reply.verdict = open.empty() == asks_open ? Verdict::no : Verdict::yes;
  for (const EnvironmentPart& part : open) reply.places.push_back(part.name);
  const std::vector<EnvironmentPart>& named = open.empty() ? closed : open;
  const PartMotion& motion = *named.front().motion;
  // Looks before and after that agree make it likely that nobody touched it in between.
  const std::string seen = context.times.text(motion.seen->time);
  const bool between = motion.next_seen.has_value();
  reply.text = fmt::format(
      "{}{}: {} {} {}, {}.", *reply.verdict == Verdict::yes ? "Yes" : "No", between ? ", probably" : "",
      list_of(named), is_or_was(context, named.size()), state_name(!open.empty()),
      between ? fmt::format("as seen at {} and {}", seen, context.times.text(motion.next_seen->time))
              : "as of " + seen);
}

/// Which parts are open, closed, or did not open.
void parts_in_state(const OpensAnswer& answer, const ReplyContext& context, Reply& reply) {
  const bool opened = answer.state == "unopened";
  const std::string state = opened ? "not opened" : answer.state,
                    other = opened ? "opened" : state_name(answer.state != "open");
  const auto are = [&](const std::vector<EnvironmentPart>& parts) {
    return opened ? (parts.size() > 1 ? "were" : "was") : is_or_was(context, parts.size());
  };
  const bool all_known = answer.not_observed.empty();
  std::vector<std::string> said;
  if (!answer.parts.empty())
    said.push_back(fmt::format("{} {} {}", list_of(answer.parts), are(answer.parts), state));
  if (!all_known) said.push_back("not observed: " + list_of(answer.not_observed));
  if (answer.parts.empty() && !answer.others.empty())
    said.push_back(fmt::format("{}{} {} {}", all_known ? "none: " : "", list_of(answer.others),
                               are(answer.others), other));
  for (const EnvironmentPart& part : answer.parts) reply.places.push_back(part.name);
  reply.not_known = answer.parts.empty() && !all_known;
  if (!reply.not_known) reply.number = answer.parts.size();
  reply.text = said.empty() ? fmt::format("Nothing is known to be {}.", state)
                            : fmt::format("{}.", fmt::join(said, "; "));
}

}  // namespace

void write_reply(const OpensAnswer& answer, const ReplyContext& context, Reply& reply) {
  const Asks asks = context.query.asks;
  const std::vector<EnvironmentPart>& parts = answer.parts;
  state_evidence(answer.parts, context, reply);
  if (!answer.state.empty()) {
    parts_in_state(answer, context, reply);
  } else if (parts.empty() && asks == Asks::property &&
             !Snapshot(context.store, context.as_of).places_meant(answer.asked).empty()) {
    // The state of what does not move is what is on it.
    write_reply(ask(context.store, ContentsQuestion{answer.asked, context.as_of}), context, reply);
  } else if (parts.empty()) {
    reply.not_known = true;
    reply.text = answer.asked.empty() ? "Nothing is known to open."
                                      : fmt::format("'{}' has no part that moves.", answer.asked);
  } else if (asks == Asks::last_time) {
    last_opened(answer, context, reply);
  } else if (asks == Asks::open || asks == Asks::closed || asks == Asks::property) {
    opens_verdict(answer, asks != Asks::closed, context, reply);
  } else {
    reply.number = parts.size();
    reply.text = fmt::format("{} can be opened: {}.", counted(parts.size(), "part"), list_of(parts));
  }
}

}  // namespace loci::memory
