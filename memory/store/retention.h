#pragma once

#include "memory/store/store.h"

namespace loci::memory {

/// How long what was seen is kept how well; ages from the memory's last scene back. Unset = for ever.
struct RetentionRules {
  /// Older scenes lose whole images, depth thumbnails with their kinds, and clouds: crops remain.
  std::optional<double> images_s = {};
  /// Older ones lose crops, masks and large arrays too: numbers remain.
  std::optional<double> crops_s = {};
  /// Older ones lose what `why` and `reason` rest on (table reasoning): what was concluded remains.
  std::optional<double> reasoning_s = {};
};

struct RetentionResult {
  int64_t scenes_without_images = 0, observations_without_points = 0, observations_without_crops = 0;
  int64_t arrays = 0, scenes_without_reasoning = 0;
  int64_t bytes_before = 0, bytes_after = 0;  ///< of the file
};

/// Lets go of what the rules say, for good: the bytes are gone from the file and its log. What was observed,
/// believed and decided stays. The run that did it keeps rules and counts as its configuration.
RetentionResult retain(const std::filesystem::path& memory, const RetentionRules& rules);

}  // namespace loci::memory
