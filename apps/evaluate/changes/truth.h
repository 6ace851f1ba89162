#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "mapping/base/math/pose.h"
#include "mapping/recording/recording.h"

namespace loci::apps::changes {

/// What truly happened to an object between two frames in which it could be seen. `turned` stands where it
/// stood, `recoloured` too; `uncertain` does not count: a person was not sure, or nobody could see it.
inline constexpr const char* kTrueKinds[] = {"unchanged",  "moved", "moved and turned", "turned",
                                             "recoloured", "added", "removed",          "uncertain"};

/// An object that is visible in a frame: the box of its visible points, map frame.
struct TrueObject {
  std::string name;
  Vector3d centre = Vector3d::Zero();
  Vector3d size = Vector3d::Zero();
  std::optional<std::array<int, 4>> pixels;  ///< x, y, width, height of what is visible in the depth image
};

struct TrueTransition {
  int64_t from_frame = 0, to_frame = 0;  ///< indexes in the recording
  std::string object;
  std::string kind;  ///< one of kTrueKinds
};

struct Truth {
  std::map<int64_t, std::vector<TrueObject>> visible;  ///< by frame index
  /// Objects that are there but hardly visible: whether they are found does not count.
  std::map<int64_t, std::vector<TrueObject>> barely;
  std::vector<TrueTransition> transitions;
  /// What belongs to the room and stands about at all times: that it is found is neither right nor wrong.
  std::vector<TrueObject> clutter;
  /// Frame by frame all objects of the world, seen or not, and how often each had been handled by then.
  std::map<int64_t, std::map<std::string, int>> handled;
};

/// Reads objects.csv and transitions.csv (the layout of osd_changes), or truth.jsonl of a simulated
/// recording. Error when the folder has neither.
Truth read_truth(const std::filesystem::path& folder, const mapping::Recording& recording);

/// What stands about in a world and does not belong to its furniture: links whose names begin with bottle,
/// box, crate, cup, kettle, pot or toaster.
std::vector<TrueObject> clutter_of(const std::filesystem::path& urdf,
                                   const std::vector<std::filesystem::path>& package_paths,
                                   Warnings& warnings);

}  // namespace loci::apps::changes
