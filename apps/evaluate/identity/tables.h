#pragma once

#include <string>

#include "apps/evaluate/identity/experiment.h"

namespace loci::apps::identity_experiment {

/// Every table and figure as text.
std::string text_of(const ExperimentResult& result, bool verbose);

/// {"A": {"paper": {"0.025": {"association", "explanation", …}, …}, …}, …, "evidence", "actions"}.
Json json_of(const ExperimentResult& result);

}  // namespace loci::apps::identity_experiment
