#pragma once

#include "memory/store/store.h"

namespace loci::memory {

/// How the second memory's map frame lies in the first one's: turned about the vertical, then moved.
struct FrameChange {
  Vector3d translation = Vector3d::Zero();
  double yaw = 0;  ///< radians

  bool is_none() const { return translation.isZero(0) && yaw == 0; }
};

struct MergeResult {
  int64_t scenes = 0, observations = 0, objects = 0, facts = 0;  ///< that came in from the second memory
  int64_t known_scenes = 0;  ///< of the second memory that the first one had already
  int64_t reasoning = 0;     ///< scenes whose reasoning stays behind, as it is in the other frame
  std::vector<std::pair<std::string, std::string>> renamed = {};  ///< places of one name at two spots
};

/// Joins two memories of one home, of several robots or runs, into a new file: every row of both, each once.
/// Scenes are known by recording and frame, else by their times, so that what was merged before is not added
/// again. Objects keep their histories apart: that two robots saw the same thing is found by reasoning anew
/// over the result. With `frame` unset both must be in one map frame (the same map, or a common recording);
/// otherwise Error. Error also when `output` exists.
MergeResult merge(const std::filesystem::path& first, const std::filesystem::path& second,
                  const std::filesystem::path& output, const std::optional<FrameChange>& frame,
                  Progress& progress);

}  // namespace loci::memory
