#pragma once

#include "memory/questions/answers.h"

namespace loci::memory {

// What is with what: near by, in the same scenes, in the same arrangement.

/// Metres of "0.5", "0.5 m", "50 cm" or "300 mm". Error for anything else and for what is not above 0.
double read_length(const std::string& text);

/// What is within a radius of a point or thing?
struct NearQuestion {
  std::string subject = {};  ///< "1.2,0.4" or "1.2,0.4,0.9" (map frame, metres), an object or a place
  double radius_m = 0.5;
  AsOf as_of = {};
};
struct NearObject {
  ObjectState object = {};
  double distance_m = 0;  ///< between centres; level when the point has no height
};
struct NearAnswer {
  std::string asked = {};
  std::string around = {};  ///< what the point is: "object_3", "table_1" or "" for coordinates
  Vector3d point = Vector3d::Zero();
  bool level = false;  ///< the point has no height
  double radius_m = 0;
  std::vector<NearObject> objects = {};  ///< nearest first; what has gone is left out
};
NearAnswer ask(const Store& store, const NearQuestion& question);

/// How often are A and B seen together? Without B: what is seen most with A.
struct TogetherQuestion {
  std::string subject = {};
  std::string other = {};  ///< empty = everything else
  AsOf as_of = {};
};
struct Company {
  ObjectRef object = {};
  size_t scenes = 0;      ///< in which it was seen
  size_t together = 0;    ///< in which both were
  size_t same_place = 0;  ///< in which both were at one place
  double share = 0;       ///< of the scenes that saw either, those that saw both
  std::optional<SceneRef> last = {};
};
struct TogetherObject {
  ObjectRef object = {};
  size_t scenes = 0;
  std::vector<Company> company = {};  ///< most scenes together first
};
struct TogetherAnswer {
  std::string asked = {}, other = {};
  std::vector<TogetherObject> objects = {};
};
TogetherAnswer ask(const Store& store, const TogetherQuestion& question);

/// What is missing from the arrangement at a place? What was there in most visits in which something of what
/// is there now was there too.
struct MissingQuestion {
  std::string place = {};     ///< empty = every place
  std::string occasion = {};  ///< only visits at these hours: breakfast, lunch, tea, dinner; empty = any
  AsOf as_of = {};
};
struct ExpectedObject {
  ObjectState now = {};
  size_t visits = 0;  ///< in which it was there
  double share = 0;   ///< of the visits that count
};
struct MissingPlace {
  PlaceRef place = {};
  size_t visits = 0;                         ///< that count
  std::vector<ExpectedObject> present = {};  ///< believed to be there now
  std::vector<ExpectedObject> missing = {};  ///< in at least half of the visits, but not there now
};
struct MissingAnswer {
  std::string asked = {}, occasion = {};
  std::vector<MissingPlace> places = {};
};
MissingAnswer ask(const Store& store, const MissingQuestion& question);

/// What kind of scene is this (§3.2.4)? The scenes with most objects in common, and the occasion whose scenes
/// it is most like.
struct KindQuestion {
  std::optional<Id> scene = {};  ///< unset = the last one
  AsOf as_of = {};
};
struct LikeScene {
  SceneRef scene = {};
  double likeness = 0;  ///< objects in common over objects in either
};
struct KindAnswer {
  SceneRef scene = {};
  std::vector<ObjectRef> objects = {};   ///< seen in it
  std::vector<std::string> places = {};  ///< where they are
  std::vector<std::pair<std::string, double>> occasions =
      {};                            ///< probability, most first; other scenes decide
  std::vector<LikeScene> like = {};  ///< most alike first, at most five
};
KindAnswer ask(const Store& store, const KindQuestion& question);

}  // namespace loci::memory
