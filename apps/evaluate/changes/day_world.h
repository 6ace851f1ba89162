#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "mapping/base/error.h"
#include "mapping/base/math/pose.h"

namespace loci::apps::changes {

/// Map frame, metres.
struct View {
  Vector3d from, at;
};

/// Something to put objects on, or a part of it: a rectangle on its top.
struct Support {
  std::string link;
  double x = 0, y = 0;                 ///< half of the rectangle's sides, metres
  std::vector<View> views;             ///< that show it
  Vector2d middle = Vector2d::Zero();  ///< of the rectangle, from the middle of the link's top
  Vector2d row = Vector2d::Zero();     ///< where the middle one of a row of cups stands, likewise
  std::vector<Vector2d> blocked = {};  ///< what belongs to the kitchen stands here (sinks, hobs), likewise
};

/// Something that opens, and the place from where one sees into it.
struct Drawer {
  std::string name;
  double open_m = 0;
  View view;
  double room_m = 0.2;  ///< above its bottom
};

/// A kitchen in which random days can be: where objects stand and from where one looks at them.
struct DayWorld {
  std::vector<Support> supports;  ///< the row of cups stands on the first
  std::vector<Drawer> drawers;
  std::string prefix = {};  ///< of the names of objects, which must not be those of links
};

constexpr double kCupSpacing = 0.14;  ///< metres, in the row

/// "kitchen" or "kitchen_l" (of apps/samples). Error for others.
const DayWorld& sample_day_world(const std::string& name);

/// Looks for supports and views in any world, the same for the same seed: up to five free stretches of
/// counters, tables, islands and shelves, and places on the floor from where one sees them. Without drawers.
/// Error where there is none with room for a row of cups.
DayWorld find_day_world(const std::filesystem::path& urdf,
                        const std::vector<std::filesystem::path>& package_paths, uint64_t seed,
                        Warnings& warnings);

}  // namespace loci::apps::changes
