#pragma once

#include <cmath>

namespace loci {

/// The logistic function.
inline double probability_from_log_odds(double log_odds) {
  return 1 / (1 + std::exp(-log_odds));
}

/// Its inverse, for probabilities in (0, 1).
inline double log_odds(double probability) {
  return std::log(probability / (1 - probability));
}

}  // namespace loci
