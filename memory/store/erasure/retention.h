#pragma once

#include "memory/store/store.h"

namespace loci::memory {

/// How long what was recorded is kept, as an age before the last scene of the memory. Unset = for ever.
struct RetentionRules {
  /// Older scenes lose images, depth thumbnails with their pixel kinds, and clouds: crops remain.
  std::optional<double> images_s = {};
  /// Older ones lose crops, masks and large arrays too: numbers remain. Not shorter than images_s.
  std::optional<double> crops_s = {};
  /// Older ones lose what `why` and `reason` need (table reasoning): what was concluded remains.
  std::optional<double> reasoning_s = {};
};

struct RetentionResult {
  int64_t scenes_without_images = 0, observations_without_points = 0, observations_without_crops = 0;
  int64_t arrays = 0, scenes_without_reasoning = 0;
  int64_t bytes_before = 0, bytes_after = 0;  ///< of the file
};

/// Makes a copy of a memory without free pages, changes it, and puts it in the memory's place, or at `output`
/// where one is given: nothing that `change` removed is in the file. The old file stays until the new one is
/// complete. Error, and nothing changes, while another program has the memory open (with `output`: while one
/// writes to it).
void rewrite_memory(const std::filesystem::path& memory, const std::filesystem::path& output,
                    const std::function<void(Store&)>& change);

/// Discards what the rules name, by rewrite_memory(). What was observed, believed and decided remains. The
/// run that did it stores rules and counts as its configuration.
RetentionResult retain(const std::filesystem::path& memory, const RetentionRules& rules,
                       const std::filesystem::path& output = {});

}  // namespace loci::memory
