#pragma once

#include "mapping/base/text/json_fwd.h"
#include "memory/questions/replies/answer_parts.h"
#include "memory/questions/time_parser.h"

namespace loci::memory {

// Which objects are seen together: co-occurrence, missing, scene-type.

struct Question;
struct Reply;
struct ReplyContext;
std::vector<Question> co_occurrence_questions();

// ---- co-occurrence

struct CoOccurrenceQuestion {
  std::string subject = {};
  std::string other = {};  ///< empty = all others
  AsOf as_of = {};
};
struct CoOccurrence {
  ObjectRef object = {};
  size_t scenes = 0;      ///< in which it was seen
  size_t together = 0;    ///< in which both were
  size_t same_place = 0;  ///< in which both were at one place
  double share = 0;       ///< of the scenes that saw either, those that saw both
  std::optional<SceneRef> last = {};
};
struct CoOccurrences {
  ObjectRef object = {};
  size_t scenes = 0;
  std::vector<CoOccurrence> others = {};  ///< most scenes together first
};
struct CoOccurrenceAnswer {
  std::string asked = {}, other = {};
  std::vector<CoOccurrences> objects = {};
};
CoOccurrenceAnswer ask(const Store& store, const CoOccurrenceQuestion& question);
std::string to_text(const CoOccurrenceAnswer& answer, const TimeWriter& times);
void write_reply(const CoOccurrenceAnswer& answer, const ReplyContext& context, Reply& reply);
Json to_json(const CoOccurrenceAnswer& answer);

// ---- missing: what was at a place in most visits that showed something of what is there now

struct MissingQuestion {
  std::string place = {};     ///< empty = every place
  std::string occasion = {};  ///< only visits at these hours: breakfast, lunch, tea, dinner; empty = any
  AsOf as_of = {};
  std::string subject = {};  ///< only these objects; empty = all
};
struct ExpectedObject {
  ObjectBelief now = {};
  size_t visits = 0;  ///< in which it was there
  double share = 0;   ///< of the visits that count
};
struct MissingPlace {
  PlaceRef place = {};
  size_t visits = 0;                         ///< that count
  std::vector<ExpectedObject> present = {};  ///< believed to be there now
  std::vector<ExpectedObject> missing = {};  ///< in at least half of the visits, but not there now
  std::vector<ExpectedObject> seldom = {};   ///< that were asked for: in less than half of the visits
};
/// Why something is missing at a place, or nothing is: "all 3 that were there in at least half of 5 visits
/// are there".
std::string reason_of(const MissingPlace& place);
struct MissingAnswer {
  std::string asked = {}, occasion = {}, subject = {};
  std::vector<MissingPlace> places = {};
};
MissingAnswer ask(const Store& store, const MissingQuestion& question);
std::string to_text(const MissingAnswer& answer, const TimeWriter& times);
void write_reply(const MissingAnswer& answer, const ReplyContext& context, Reply& reply);
Json to_json(const MissingAnswer& answer);

// ---- scene-type (§3.2.4): the scenes with most objects in common, and the occasion whose scenes are most
// similar

struct SceneTypeQuestion {
  std::optional<Id> scene = {};  ///< unset = the last one
  AsOf as_of = {};
};
struct SimilarScene {
  SceneRef scene = {};
  double similarity = 0;  ///< objects in common over objects in either
};
struct SceneTypeAnswer {
  SceneRef scene = {};
  std::vector<ObjectRef> objects = {};   ///< seen in it
  std::vector<std::string> places = {};  ///< where they are
  std::vector<std::pair<std::string, double>> occasions =
      {};                                  ///< and their probabilities, most probable first
  std::vector<SimilarScene> similar = {};  ///< most similar first, at most five
};
SceneTypeAnswer ask(const Store& store, const SceneTypeQuestion& question);
std::string to_text(const SceneTypeAnswer& answer, const TimeWriter& times);
Json to_json(const SceneTypeAnswer& answer);

}  // namespace loci::memory
