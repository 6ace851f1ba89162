#pragma once

#include <string>
#include <vector>

#include "gui/data/open_memory.h"

namespace loci::gui {

/// How one belief differs from another.
struct Difference {
  memory::EventKind kind = memory::EventKind::moved;  ///< appeared, moved, gone or joint_changed
  int64_t object = 0;                                 ///< 0 = of a joint
  std::string name = {};                              ///< of the object or joint
  std::string then = {};  ///< where it was, or how far it was open; empty = not known then
  std::string now = {};
  double distance = 0;  ///< metres that it moved
};

/// Two memories may call one place by two names: there positions decide whether an object moved.
enum class PlaceNames { of_one_memory, of_two_memories };

/// The differences from `then` to `now`: what appeared, what moved (to another place, or
/// further than `min_move` metres), what is gone, and joints that moved. In that order, then by object.
std::vector<Difference> differences(const Belief& then, const Belief& now,
                                    PlaceNames names = PlaceNames::of_one_memory, double min_move = 0.05);

/// Another memory's belief with the ids of the same objects here: of the nearest object of the same colour
/// within `within` metres. Objects without one get an id below 0.
Belief renumbered(Belief other, const Belief& here, double within = 0.3);

}  // namespace loci::gui
