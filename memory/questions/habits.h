#pragma once

#include <map>

#include "memory/questions/answers.h"

namespace loci::memory {

// What is usual, counted over all sightings: how often X was seen at a place, and what a place is used for.

struct UsualQuestion {
  std::string subject = {};
  AsOf as_of = {};
  /// Only what was seen then: hours ("noon", "morning", "9 to 11"), days of the week ("Mondays", "weekend"),
  /// or both ("Monday morning"); empty = whenever. Else an Error that shows what can be written.
  std::string during = {};
};
/// A place where an object was seen.
struct UsualPlace {
  PlaceRef place = {};
  size_t sightings = 0;                   ///< scenes in which it was seen there
  double share = 0;                       ///< of all its sightings at places
  std::map<int, size_t> by_hour = {};     ///< sightings by local hour, 0 to 23
  std::map<int, size_t> by_weekday = {};  ///< sightings by local weekday, 0 = Monday
  SceneRef last = {};
};
struct UsualObject {
  ObjectState now = {};
  std::vector<UsualPlace> places = {};  ///< most sightings first, then by name
};
struct UsualAnswer {
  std::string asked = {};
  std::string during = {};  ///< as in the question
  std::vector<UsualObject> objects = {};
};

/// What do we keep on or in a place?
struct KeptQuestion {
  std::string place = {};
  AsOf as_of = {};
};
struct KeptObject {
  ObjectState now = {};
  size_t sightings = 0;  ///< scenes in which it was seen there
  double share = 0;      ///< of all its sightings at places
  SceneRef first = {}, last = {};
  bool still_there = false;  ///< is believed to be there
};
struct KeptPlace {
  PlaceRef place = {};
  size_t looks = 0;  ///< scenes that saw any of it
  std::optional<SceneRef> last_look = {};
  std::vector<KeptObject> objects = {};  ///< most sightings first
};
struct KeptAnswer {
  std::string asked = {};
  std::vector<KeptPlace> places = {};
};

UsualAnswer ask(const Store& store, const UsualQuestion& question);
KeptAnswer ask(const Store& store, const KeptQuestion& question);

}  // namespace loci::memory
