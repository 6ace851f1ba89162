#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "mapping/base/progress.h"
#include "mapping/base/text/json_fwd.h"
#include "perception/annotators/structure/known_structure.h"

namespace loci::apps::filter_evaluation {

/// What the filter leaves of a recording.
struct Removal {
  std::string name;
  size_t frames = 0;
  size_t points = 0;   ///< measured
  size_t known = 0;    ///< the map explains them
  size_t outside = 0;  ///< in no region of interest

  double removed() const;  ///< share
};

/// Filters every frame that has a pose against a map.
Removal measure_removal(const std::filesystem::path& recording, perception::KnownMap& map,
                        const perception::KnownStructureOptions& options, int threads, Progress& progress);

std::string removal_text(const std::vector<Removal>& removals);
Json removal_json(const std::vector<Removal>& removals);

}  // namespace loci::apps::filter_evaluation
