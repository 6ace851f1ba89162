#pragma once

#include <compare>
#include <limits>

#include "mapping/base/text/json_fwd.h"
#include "memory/questions/replies/answer_parts.h"
#include "memory/questions/time_parser.h"

namespace loci::memory {

// What happened and when: changes, scenes, timeline.

struct Question;
struct Reply;
struct ReplyContext;
std::vector<Question> event_questions();

// ---- changes

struct ChangesQuestion {
  std::optional<TimeNs> from = {}, to = {};
  std::string subject = {};  ///< empty = all objects
  std::string place = {};    ///< empty = everywhere
  AsOf as_of = {};
  /// A kind of Change, or "left" (gone, or moved away from the place asked about) and "came" (appeared,
  /// reappeared, or moved there), "handled" (moved, gone or reappeared), "opened" or "closed" of a joint; a
  /// move neither left nor came where no place is asked about. Empty = all.
  std::string kind = {};
  std::string other = {};  ///< only moves between `place` and this place; with "came" only those from there
  size_t min_times = 1;    ///< only of what changed so often
};
struct ChangesAnswer {
  std::optional<TimeNs> from = {}, to = {};
  std::vector<Change> changes = {};
  /// Where there are none: those that the first look after the period showed, within a day, and which may
  /// have happened in it.
  std::vector<Change> perhaps = {};
};
inline constexpr TimeNs kAlways = std::numeric_limits<TimeNs>::min();  ///< no look was before it
/// The time in which a change happened: from the look before it, or kAlways, to the one that showed it.
TimeSpan bounds_of(const Change& change);
/// From when to when all of the changes, of which there are some, happened.
TimeSpan hull_of(const std::vector<Change>& changes);
/// Which of two events was earlier; unordered where the times in which they happened overlap.
std::partial_ordering order_of(const TimeSpan& one, const TimeSpan& other);
/// Of the time in which a change may have happened, the part before a time: the look at nine shows what
/// happened since the look at eight.
double share_before(const Change& change, TimeNs time);
/// Error that lists the kinds for an unknown one.
ChangesAnswer ask(const Store& store, const ChangesQuestion& question);
std::string to_text(const ChangesAnswer& answer, const TimeWriter& times);
void write_reply(const ChangesAnswer& answer, const ReplyContext& context, Reply& reply);
Json to_json(const ChangesAnswer& answer);

// ---- scenes

struct ScenesQuestion {
  std::optional<TimeNs> from = {}, to = {};
  AsOf as_of = {};
};
struct SceneSummary {
  SceneRef scene = {};
  size_t observations = 0;
  bool has_pose = false;
  bool forgotten = false;                                        ///< what it saw was forgotten on request
  std::vector<std::pair<std::string, double>> seen_places = {};  ///< and the fraction of each that it saw
  TimeNs known_from = 0;
};
struct ScenesAnswer {
  std::vector<SceneSummary> scenes = {};
};
ScenesAnswer ask(const Store& store, const ScenesQuestion& question);
std::string to_text(const ScenesAnswer& answer, const TimeWriter& times);
void write_reply(const ScenesAnswer& answer, const ReplyContext& context, Reply& reply);
Json to_json(const ScenesAnswer& answer);

// ---- timeline

struct TimelineQuestion {
  std::optional<TimeNs> from = {}, to = {};
  AsOf as_of = {};
};
struct TimelineEntry {
  SceneSummary scene = {};
  std::vector<ObjectRef> seen = {};
  std::vector<Change> changes = {};
};
struct TimelineAnswer {
  std::vector<TimelineEntry> entries = {};
};
TimelineAnswer ask(const Store& store, const TimelineQuestion& question);
std::string to_text(const TimelineAnswer& answer, const TimeWriter& times);
void write_reply(const TimelineAnswer& answer, const ReplyContext& context, Reply& reply);
Json to_json(const TimelineAnswer& answer);

}  // namespace loci::memory
