#pragma once

#include <string>
#include <utility>
#include <vector>

namespace loci::apps::changes {

/// Stated probability, and whether it is so.
using Stated = std::vector<std::pair<double, bool>>;

/// Statements of similar probability.
struct ReliabilityBin {
  size_t count = 0;
  double stated = 0, right = 0;  ///< mean probability; share that is so
};

/// Bins of equal count, in order of probability: ten at most, of 30 statements at least. None without
/// statements.
std::vector<ReliabilityBin> reliability_bins(Stated stated);

/// Expected calibration error over reliability_bins(); 0 without statements.
double calibration_error(const Stated& stated);

/// Mean squared error of the probabilities; 0 without statements.
double brier_score(const Stated& stated);

/// A drawing (SVG): for each kind of statement a panel with right against stated, 95 % intervals [Wilson
/// 1927], and the number of statements of each bin. Kinds without statements are left out.
std::string reliability_diagrams(const std::vector<std::pair<std::string, Stated>>& kinds);

}  // namespace loci::apps::changes
