#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "mapping/base/progress.h"
#include "mapping/base/text/json_fwd.h"
#include "perception/annotators/structure/known_map.h"

namespace loci::apps::filter_evaluation {

/// How well the joints of a recording are told from its depth images alone. Truth is the recording's own
/// joint states, which the estimate does not see.
struct JointFits {
  std::string name;
  size_t frames = 0;
  size_t fronts = 0;        ///< in view in so many points that they could be determined, summed over frames
  size_t determined = 0;    ///< of these
  size_t open = 0;          ///< of those determined, that truly stand open
  size_t found_open = 0;    ///< of these, told so within the tolerance
  size_t false_open = 0;    ///< of those truly shut
  std::vector<double> off;  ///< metres of the farthest point, ascending, of those told to be open
};

/// Fits the joints of every frame that has a pose and joint states.
JointFits measure_joints(const std::filesystem::path& recording, const perception::KnownMap& map, int threads,
                         Progress& progress);

std::string joints_text(const std::vector<JointFits>& fits);
Json joints_json(const std::vector<JointFits>& fits);

}  // namespace loci::apps::filter_evaluation
