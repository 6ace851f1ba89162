#pragma once

#include <filesystem>
#include <vector>

#include "mapping/base/time.h"
#include "mapping/world/kinematics.h"

namespace loci::perception {

/// A robot that may be in view, and how its joints stood.
struct KnownRobot {
  struct Row {
    TimeNs time_ns = 0;
    JointState joints;  ///< all that were named until then
  };

  mapping::World world;
  size_t part = 0;        ///< in KnownMap::scene
  std::vector<Row> rows;  ///< in order of time

  /// The latest state that is not later; the first one before that; joints at 0 without any.
  JointState joints_at(TimeNs time) const;

  /// Rows from a file as recordings have it (time_ns,joint,position), or without the column of times.
  static std::vector<Row> read_joints(const std::filesystem::path& path, const mapping::World& world);
};

}  // namespace loci::perception
