#pragma once

#include <string>
#include <vector>

#include "mapping/base/json_fwd.h"

namespace loci::apps::identity_experiment {

/// How long one problem takes to solve exactly on one core.
struct SpeedRow {
  std::string problem;
  double milliseconds = 0;  ///< processor time, best of the repetitions
  double aim_milliseconds = 0;
  double gate_bound = 0;  ///< largest error of a probability
};

/// Weights, marginals and the most probable matching, as every scene needs them.
std::vector<SpeedRow> measure_speed(int seed);

std::string text_of(const std::vector<SpeedRow>& rows);
Json json_of(const std::vector<SpeedRow>& rows);

}  // namespace loci::apps::identity_experiment
