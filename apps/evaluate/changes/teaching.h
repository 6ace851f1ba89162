#pragma once

#include <filesystem>
#include <string>

#include "apps/evaluate/changes/calibration.h"
#include "mapping/base/text/json_fwd.h"

namespace loci::apps::changes {

/// Classes that are taught by one example each, and what the memory makes of all other objects.
struct TeachingScore {
  size_t of_taught = 0, right = 0, wrong = 0;  ///< objects of taught classes; called so, called otherwise
  size_t of_others = 0, called = 0;  ///< objects of classes that nobody taught; called by a taught one
  Stated stated;                     ///< that an object is of the class that it is called by

  void add(const TeachingScore& other);
};

/// Teaches every other class of the true objects of a simulated day, then, from the same memory, the others;
/// `folder`: with the truth of the recording from which `memory` was made. Works on copies beside the memory.
TeachingScore score_teaching(const std::filesystem::path& folder, const mapping::Recording& recording,
                             const std::filesystem::path& memory);

std::string text(const TeachingScore& score);
Json to_json(const TeachingScore& score);

}  // namespace loci::apps::changes
