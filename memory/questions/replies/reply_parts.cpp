#include "memory/questions/replies/reply_parts.h"

#include <fmt/format.h>

#include <algorithm>

#include "mapping/base/text/text.h"
#include "memory/questions/events.h"
#include "memory/questions/replies/answer_format.h"
#include "memory/wordnet/wordnet.h"

namespace loci::memory::replies {

using namespace format;

bool is_there(const ObjectBelief& object) {
  return object.status != ObjectStatus::gone && object.status != ObjectStatus::missed &&
         object.probability >= kLikely;
}

std::string adverb(double probability) {
  return probability >= kSure ? "" : probability >= kLikely ? "probably " : "perhaps ";
}

std::string with_probability(bool yes, double probability) {
  const char* verdict = yes ? "Yes" : "No";
  return probability >= kSure ? verdict : fmt::format("{}, with {}", verdict, percent(probability));
}

std::string bounds_text(TimeNs least, std::optional<TimeNs> most) {
  const std::string lower = duration_text(least), upper = most ? duration_text(*most) : "";
  if (lower.empty() && upper.empty()) return "Less than a minute";
  if (upper.empty() || lower == upper) return most ? lower : "At least " + lower;
  return lower.empty() ? "At most " + upper : fmt::format("At least {}, at most {}", lower, upper);
}

std::optional<Change> left_around(Id object, TimeNs time, const Snapshot& snapshot) {
  const AsOf known{.at = {}, .known_at = snapshot.as_of().known_at};
  for (const EventRow& event : snapshot.store().events_of(object, known, time)) {
    if (event.kind != EventKind::gone && event.kind != EventKind::moved) continue;
    const bool around = event.since && *event.since <= time && event.clock.valid_from > time;
    return around ? std::optional(snapshot.change(event)) : std::nullopt;
  }
  return std::nullopt;
}

std::string spot_in_words(const std::optional<PlaceRef>& place, const std::optional<Vector3d>& position) {
  return place ? in_words(*place) : spot_text(place, position);
}

bool is_plural(std::string_view word) {
  if (!word.ends_with('s')) return false;
  const std::string lower = lower_case(word);
  const std::vector<std::string> bases = wordnet::base_forms(lower, wordnet::PartOfSpeech::noun);
  return !bases.empty() && std::ranges::count(bases, lower) == 0;
}

const char* is_or_was(const ReplyContext& context, size_t count) {
  const std::string at = context.query.argument("at");
  const bool now = at.empty() || at == "now";
  return count > 1 ? (now ? "are" : "were") : now ? "is" : "was";
}

namespace {

/// "seen in 8 scenes, last at 20:30 (scene 24)".
std::string seen_text(const ObjectBelief& object, const TimeWriter& times) {
  std::string text = "seen in " + counted(object.sightings, "scene");
  if (object.last_seen)
    text +=
        fmt::format(", last at {} ({})", times.text(object.last_seen->time), scene_text(*object.last_seen));
  if (object.last_missed) text += "; " + looked_for_text({object.last_missed->time}, "", times);
  return text;
}

}  // namespace

TimeSpan at_once(TimeNs time) {
  return {time, time};
}

size_t wanted_count(const Query& query) {
  return static_cast<size_t>(std::max(0, count_of(query.argument("count")).value_or(0)));
}

void add_sightings(const std::vector<ObjectBelief>& objects, const Names& names, const ReplyContext& context,
                   Reply& reply) {
  for (const ObjectBelief& object : objects) {
    if (reply.evidence.size() == kMaxEvidenceLines) return;
    const std::string spot = object.status == ObjectStatus::gone ? "gone, was " : "";
    reply.evidence.push_back(fmt::format("{} ({}): {}{} {}, {}", names.of(object.object), object.object.name,
                                         spot, spot_in_words(object.place, object.position),
                                         percent(object.probability), seen_text(object, context.times)));
  }
}

std::string without_place(std::string name) {
  for (const char* preposition : {" on ", " in "})
    if (const size_t at = name.find(preposition); at != std::string::npos) name.resize(at);
  return name;
}

std::string bare_subject(const ObjectRef& object, const Names& names) {
  return without_place(names.subject(object));
}

std::string gone_text(const ObjectBelief& object, const Names& names, const TimeWriter& times) {
  std::string text = names.subject(object.object) + " has gone";
  if (object.last_seen)
    text += fmt::format("; it was last seen {} at {}", spot_in_words(object.place, object.position),
                        times.text(object.last_seen->time));
  return text + ".";
}

std::string reason_of(const ObjectBelief& object, const Names& names, const ReplyContext& context) {
  if (!object.last_seen)
    return fmt::format("Nothing is known of {} but its name.", names.subject(object.object));
  const std::string when = context.times.text(object.last_seen->time),
                    spot = spot_in_words(object.place, object.position);
  if (object.status == ObjectStatus::gone && object.last_missed)
    return fmt::format("Because {} was {}.", bare_subject(object.object, names),
                       looked_for_text({object.last_missed->time}, spot, context.times));
  return fmt::format("Because {} was last seen {} at {}.", bare_subject(object.object, names), spot, when);
}

void add_out_of_sight(size_t count, Reply& reply) {
  if (count == 0 || !reply.number || *reply.number == 0) return;
  reply.out_of_sight = count;
  const std::string more = fmt::format("; and {} out of sight.", count);
  if (reply.text.ends_with('.') && reply.text.size() - 1 + more.size() <= kMaxReplyLength)
    reply.text.replace(reply.text.size() - 1, 1, more);
}

std::string between_text(const TimeSpan& bounds, const TimeWriter& times) {
  const std::string last = times.text(bounds.last);
  if (bounds.first == kAlways) return "By " + last;
  const std::string first = times.text(bounds.first);
  return first == last ? "At " + last : fmt::format("Between {} and {}", first, last);
}

}  // namespace loci::memory::replies
