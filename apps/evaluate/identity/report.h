#pragma once

#include <filesystem>

#include "apps/evaluate/identity/experiment.h"
#include "mapping/base/text/json_fwd.h"

namespace loci::apps::identity_experiment {

/// Every table and figure as text.
std::string text_of(const ExperimentResult& result, bool verbose);

/// {"A": {"paper": {"0.025": {"association", "explanation", …}, …}, …}, …, "evidence", "actions"}.
Json json_of(const ExperimentResult& result);

/// Figures 6.5 and 6.8 as SVG files: success by number of objects and of actions, a line per noise level, for
/// the paper's model and ours under the first condition. Creates the folder. Returns the files.
std::vector<std::filesystem::path> write_figures(const ExperimentResult& result,
                                                 const std::filesystem::path& folder);

std::string text_of(const std::vector<SpeedRow>& rows);
Json json_of(const std::vector<SpeedRow>& rows);

}  // namespace loci::apps::identity_experiment
