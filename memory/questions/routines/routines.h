#pragma once

#include <array>
#include <map>
#include <string_view>

#include "mapping/base/text/json_fwd.h"
#include "memory/questions/replies/answer_parts.h"
#include "memory/questions/time_parser.h"

namespace loci::memory {

// What is usual, counted over all observations: usual, contents-history, life-cycle.

struct Question;
struct Reply;
struct ReplyContext;
std::vector<Question> routine_questions();

/// A meal, by local hours.
struct Occasion {
  const char* name;
  int first_hour, last_hour;
  bool covers(int hour) const { return hour >= first_hour && hour <= last_hour; }
};
inline constexpr std::array<Occasion, 5> kOccasions = {
    {{"breakfast", 5, 10}, {"lunch", 11, 14}, {"tea", 15, 17}, {"dinner", 17, 22}, {"supper", 17, 22}}};
const Occasion* find_occasion(std::string_view name);  ///< nullptr = unknown

// ---- usual: where an object usually is

struct UsualQuestion {
  std::string subject = {};
  AsOf as_of = {};
  /// Only observations then: hours ("noon", "morning", "9 to 11"), days of the week ("Mondays", "weekend"),
  /// or both
  /// ("Monday morning"); empty = all. Error for anything else.
  std::string during = {};
};
struct UsualPlace {
  PlaceRef place = {};
  size_t sightings = 0;                   ///< scenes in which it was seen there
  double share = 0;                       ///< of all its sightings at places
  std::map<int, size_t> by_hour = {};     ///< sightings by local hour, 0 to 23
  std::map<int, size_t> by_weekday = {};  ///< sightings by local weekday, 0 = Monday
  SceneRef last = {};
};
struct UsualObject {
  ObjectBelief now = {};
  std::vector<UsualPlace> places = {};  ///< most sightings first, then by name
};
struct UsualAnswer {
  std::string asked = {};
  std::string during = {};
  std::vector<UsualObject> objects = {};
};
UsualAnswer ask(const Store& store, const UsualQuestion& question);
std::string to_text(const UsualAnswer& answer, const TimeWriter& times);
void write_reply(const UsualAnswer& answer, const ReplyContext& context, Reply& reply);
Json to_json(const UsualAnswer& answer);

// ---- contents-history: what was seen at a place, ever or in a period

struct ContentsHistoryQuestion {
  std::string place = {};
  AsOf as_of = {};
  std::optional<TimeNs> from = {}, to = {};  ///< only what was seen in this period
  std::string subject = {};                  ///< only these; empty = all objects
  /// "gone": only what is no longer there; "stayed": only what is there and did not leave in the period;
  /// "new": only what is there and was not in the period; "unmoved": nor was moved; empty = all.
  std::string state = {};
  std::string during = {};  ///< only what was seen then, as for UsualQuestion
};
struct PastContent {
  ObjectBelief now = {};
  size_t sightings = 0;  ///< scenes in which it was seen there
  size_t visits = 0;     ///< in which it was seen there
  double share = 0;      ///< of all its sightings at places
  SceneRef first = {}, last = {};
  bool still_there = false;  ///< is believed to be there
};
struct PlaceContentsHistory {
  PlaceRef place = {};
  size_t looks = 0;   ///< scenes that saw at least a tenth of it
  size_t visits = 0;  ///< of which these scenes are
  std::optional<SceneRef> last_look = {};
  std::vector<PastContent> objects = {};  ///< most sightings first
};
struct ContentsHistoryAnswer {
  std::string asked = {}, during = {};
  std::vector<PlaceContentsHistory> places = {};
};
ContentsHistoryAnswer ask(const Store& store, const ContentsHistoryQuestion& question);
/// When an object was at a place, without having been elsewhere in between; what is there still is until the
/// last scene.
std::vector<TimeSpan> spans_at(const Store& store, const AsOf& as_of, const PastContent& object,
                               const PlaceRef& place);
std::string to_text(const ContentsHistoryAnswer& answer, const TimeWriter& times);
void write_reply(const ContentsHistoryAnswer& answer, const ReplyContext& context, Reply& reply);
Json to_json(const ContentsHistoryAnswer& answer);

// ---- life-cycle: from place to place, for example table → sink → dishwasher → cupboard

/// Over all objects that the subject means: "cup" gives the life cycle of cups.
struct LifeCycleQuestion {
  std::string subject = {};
  AsOf as_of = {};
};
struct LifeCyclePlace {
  PlaceRef place = {};
  size_t stays = 0;
  std::optional<double> hours = {};  ///< median from the first sighting of a stay to that of the next
};
struct LifeCycleStep {
  PlaceRef from = {}, to = {};
  size_t count = 0;
  double share = 0;  ///< of the steps that leave `from`
};
struct LifeCycleAnswer {
  std::string asked = {};
  std::vector<ObjectRef> objects = {};
  std::vector<LifeCyclePlace> places = {};  ///< most stays first
  std::vector<LifeCycleStep> steps = {};    ///< most frequent first
  /// From where most stays begin along the most frequent steps, until a place repeats.
  std::vector<PlaceRef> usual = {};
};
LifeCycleAnswer ask(const Store& store, const LifeCycleQuestion& question);
std::string to_text(const LifeCycleAnswer& answer, const TimeWriter& times);
Json to_json(const LifeCycleAnswer& answer);

}  // namespace loci::memory
