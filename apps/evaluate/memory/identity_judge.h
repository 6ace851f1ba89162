#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "mapping/base/text/json_fwd.h"

namespace loci::apps::memory_experiment {

/// What had really happened to a thing that is seen, since it was seen last.
enum class TrueEvent { stayed, moved_here, moved_elsewhere, fresh, ghost };
inline constexpr size_t kTrueEvents = 5;

/// One observation beside the truth.
struct JudgedSighting {
  int thing = -1;  ///< -1 = a false detection
  TrueEvent event = TrueEvent::stayed;
  int64_t object = 0;                    ///< that it is taken for; 0 = a false detection
  bool appeared = false, moved = false;  ///< as what it is explained
};

/// Accuracy of the data association over a whole history.
struct IdentityFigures {
  /// By TrueEvent: how many there were, and what was said.
  struct Event {
    size_t all = 0;
    size_t same = 0;      ///< the object that the thing was before
    size_t split = 0;     ///< a new object although the thing was known
    size_t confused = 0;  ///< the object of another thing
    size_t said_moved = 0;
  };
  Event events[kTrueEvents];
  size_t things = 0, objects = 0;      ///< true ones that were seen; objects that observations were taken for
  size_t visible = 0, attributed = 0;  ///< sightings of things; observations that are taken for objects
  size_t agreed = 0;                   ///< of these, that fit the best pairing of things with objects
  size_t merged = 0;                   ///< objects at least a tenth of which are sightings of another thing

  /// 2 agreed / (visible + attributed), [Ristani 2016].
  double f1() const;
};

/// Keeps count, scene by scene.
class IdentityJudge {
 public:
  void see(const std::vector<JudgedSighting>& scene);
  IdentityFigures figures() const;

 private:
  IdentityFigures figures_;
  std::map<int, int64_t> object_of_;  ///< of each thing, when it was seen last
  std::set<int64_t> owned_;           ///< objects that something was taken for
  std::map<std::pair<int, int64_t>, size_t> common_;
};

const char* true_event_name(size_t event);
std::string text_of(const IdentityFigures& figures);
Json json_of(const IdentityFigures& figures);

}  // namespace loci::apps::memory_experiment
