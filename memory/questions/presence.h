#pragma once

#include "mapping/base/text/json_fwd.h"
#include "memory/questions/replies/answer_parts.h"
#include "memory/questions/time_parser.h"
#include "memory/store/scene_images.h"

namespace loci::memory {

// Whether an object was at a place in a period: was.

class Snapshot;
struct Question;
struct Reply;
struct ReplyContext;
std::vector<Question> presence_questions();

struct WasQuestion {
  std::string subject = {};
  std::string place = {};  ///< empty = anywhere
  TimeNs from = 0;
  TimeNs to = 0;
  AsOf as_of = {};
};
/// What one scene of the period shows.
struct PlaceView {
  SceneRef scene = {};
  double fraction = 0;                      ///< of the place that it saw
  SpotStatus spot = SpotStatus::no_camera;  ///< where the object stood
};
/// What the belief says of a moment at which no look shows the object.
struct UnseenMoment {
  PlaceRef place = {};               ///< where it was
  bool there = false;                ///< that is the place asked about
  double probability = 0;            ///< of that
  TimeNs before = 0;                 ///< when it was seen there last before
  std::optional<TimeNs> after = {};  ///< when it was seen next, if that was there
};
struct WasObject {
  ObjectRef object = {};
  Verdict verdict = Verdict::not_observed;
  double probability = 0;   ///< that it was there at some time of the period, as looks and belief show it
  std::string reason = {};  ///< of any verdict but yes
  std::vector<SceneRef> seen_there = {};
  std::vector<std::pair<SceneRef, std::string>> seen_elsewhere = {};  ///< with the place's name, or ""
  std::vector<PlaceView> views = {};                                  ///< that saw any of the place
  std::vector<TimeNs> absent = {};          ///< looks that exclude that it was there
  std::optional<SceneRef> before = {};      ///< last time it was seen there before
  std::optional<SceneRef> after = {};       ///< first time it was seen there after
  std::optional<UnseenMoment> unseen = {};  ///< decides the verdict
};
struct WasAnswer {
  std::string asked = {};
  std::string place = {};  ///< empty = anywhere
  bool container = false;  ///< objects are in it rather than on it
  TimeNs from = 0, to = 0;
  Verdict verdict = Verdict::not_observed;  ///< yes if any is, no if all are not
  std::vector<WasObject> objects = {};
};
WasAnswer ask(const Store& store, const WasQuestion& question);
/// Fraction of a place that the scenes of a period saw, taken together.
double seen_fraction(const Snapshot& snapshot, const PlaceRow& place, TimeNs from, TimeNs to);
std::string to_text(const WasAnswer& answer, const TimeWriter& times);
void write_reply(const WasAnswer& answer, const ReplyContext& context, Reply& reply);
Json to_json(const WasAnswer& answer);

}  // namespace loci::memory
