#pragma once

#include <filesystem>

#include "apps/evaluate/identity/experiment.h"

namespace loci::apps::identity_experiment {

/// Figures 6.5 and 6.8 as SVG files: success by number of objects and of actions, a line per noise level, for
/// the paper's model and ours under the first condition. Creates the folder. Returns the files.
std::vector<std::filesystem::path> write_figures(const ExperimentResult& result,
                                                 const std::filesystem::path& folder);

}  // namespace loci::apps::identity_experiment
