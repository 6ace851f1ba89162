#pragma once

#include "memory/questions/answers.h"

namespace loci::memory {

// The ways that things go, and the way to find them.

/// Where does X go, again and again: table → sink → dishwasher → cupboard. Over all objects that X means, so
/// that "cup" gives the life cycle of cups.
struct LifecycleQuestion {
  std::string subject = {};
  AsOf as_of = {};
};
struct LifecyclePlace {
  PlaceRef place = {};
  size_t stays = 0;
  std::optional<double> hours = {};  ///< median from the first sighting of a stay to that of the next
};
struct LifecycleStep {
  PlaceRef from = {}, to = {};
  size_t count = 0;
  double share = 0;  ///< of the steps that leave `from`
};
struct LifecycleAnswer {
  std::string asked = {};
  std::vector<ObjectRef> objects = {};
  std::vector<LifecyclePlace> places = {};  ///< most stays first
  std::vector<LifecycleStep> steps = {};    ///< most frequent first
  /// The usual way: from where most stays begin along the most frequent steps, until a place comes again.
  std::vector<PlaceRef> usual = {};
};
LifecycleAnswer ask(const Store& store, const LifecycleQuestion& question);

/// Where to look next for X: what is believed × how much of the place a look shows ÷ the time that it takes.
struct NextLookQuestion {
  std::string subject = {};
  std::optional<Vector2d> from = {};  ///< where one stands, map frame; unset = the camera of the last scene
  AsOf as_of = {};
};
struct LookPlace {
  PlaceRef place = {};
  double probability = 0;                 ///< that it is there
  double visibility = 0;                  ///< how much of the place a look has shown, in the mean
  std::optional<double> distance_m = {};  ///< level
  double seconds = 0;                     ///< way, look, and opening what is closed
  double chance_per_minute = 0;           ///< by which the places are ordered
  std::optional<SceneRef> last_look = {};
  std::string reason = {};
};
struct NextLook {
  ObjectState now = {};
  std::vector<LookPlace> places = {};  ///< best first
};
struct NextLookAnswer {
  std::string asked = {};
  std::vector<NextLook> objects = {};
};
NextLookAnswer ask(const Store& store, const NextLookQuestion& question);

}  // namespace loci::memory
