#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "mapping/base/pose.h"

namespace loci::changes {

/// A thing that is visible in a frame: the box of its visible points, map frame.
struct TrueObject {
  std::string name;
  Vector3d centre = Vector3d::Zero();
  Vector3d size = Vector3d::Zero();
};

/// What truly happened to a thing between two frames.
struct TrueTransition {
  int64_t from_frame = 0, to_frame = 0;  ///< indexes in the recording
  std::string object;
  std::string kind;  ///< unchanged, moved, added, removed, uncertain
};

struct Truth {
  std::map<int64_t, std::vector<TrueObject>> visible;  ///< by frame index
  std::vector<TrueTransition> transitions;
};

/// Reads objects.csv and transitions.csv (the layout of osd_changes), or truth.jsonl of a simulated
/// recording. `frames` are the recording's frame indexes in order. Error when the folder has neither.
Truth read_truth(const std::filesystem::path& folder, const std::vector<int64_t>& frames);

}  // namespace loci::changes
