#pragma once

#include "memory/store/store.h"

namespace loci::memory {

/// The transform from the second memory's map frame to the first one's: a rotation about the vertical, then a
/// translation.
struct FrameChange {
  Vector3d translation = Vector3d::Zero();
  double yaw = 0;  ///< radians

  bool is_none() const { return translation.isZero(0) && yaw == 0; }
};

/// Two memories whose map frames are not known to be one.
struct FramesDiffer : Error {
  using Error::Error;
};

struct MergeResult {
  int64_t scenes = 0, observations = 0, objects = 0, facts = 0;  ///< added from the second memory
  int64_t known_scenes = 0;  ///< of the second memory, which the first one had already
  int64_t reasoning = 0;     ///< scenes whose reasoning was left out because it is in another frame
  int64_t forgotten = 0;     ///< observations of either that the other had forgotten
  std::vector<std::pair<std::string, std::string>> renamed = {};  ///< places of one name at two spots
  std::vector<std::string> left_edits = {};  ///< of the second memory, about observations of common scenes
};

/// Merges two memories of one home, of several robots or runs, into a new file. Scenes are recognised by
/// recording and frame, else by their times, so that merging again adds nothing. Of a scene that both have,
/// observations, explanations and corrections are those of the first memory; everything else of the second
/// comes along. Objects that share observations are one; others keep separate histories: reasoning again over
/// the result finds which of them are the same. What either has forgotten is not in the result, which is
/// verified before it gets its name. With `frame` unset both must be in one map frame (the same map, or a
/// common recording); otherwise Error. Error also when `output` exists, or when the result is not sound.
MergeResult merge(const std::filesystem::path& first, const std::filesystem::path& second,
                  const std::filesystem::path& output, const std::optional<FrameChange>& frame,
                  Progress& progress);

}  // namespace loci::memory
