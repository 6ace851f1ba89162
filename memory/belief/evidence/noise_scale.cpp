#include "memory/belief/evidence/noise_scale.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "memory/belief/evidence/scale_prior.h"
#include "memory/belief/parameters.h"

namespace loci::memory::belief {

NoiseScale::Levels NoiseScale::weights(double spread) const {
  const Levels prior = scale_prior(kFactors, spread);
  Levels weights{};
  const double sum = std::accumulate(counts_.begin(), counts_.end(), 0.0) + kParameters.noise_prior;
  for (size_t i = 0; i < kLevels; ++i) weights[i] = (counts_[i] + kParameters.noise_prior * prior[i]) / sum;
  return weights;
}

NoiseScale::Levels NoiseScale::main_weights(double spread) const {
  constexpr double kFar = 1.5;
  const double mean = std::sqrt(variance_factor(spread));
  Levels weight = weights(spread);
  for (size_t i = 0; i < kLevels; ++i)
    if (kFactors[i] > kFar * mean || kFactors[i] * kFar < mean) weight[i] = 0;
  const double sum = std::accumulate(weight.begin(), weight.end(), 0.0);
  for (double& share : weight) share /= sum;
  return weight;
}

double NoiseScale::variance_factor(double spread) const {
  const Levels weight = weights(spread);
  double log_factor = 0;
  for (size_t i = 0; i < kLevels; ++i) log_factor += weight[i] * std::log(kFactors[i]);
  return std::exp(2 * log_factor);
}

void NoiseScale::count(const Levels& density, double probability, double spread) {
  const Levels weight = weights(spread);
  double sum = 0;
  for (size_t i = 0; i < kLevels; ++i) sum += weight[i] * density[i];
  if (!(sum > 0)) return;
  const double keep = 1 - probability / kParameters.noise_memory;
  for (size_t i = 0; i < kLevels; ++i)
    counts_[i] = keep * counts_[i] + probability * weight[i] * density[i] / sum;
}

}  // namespace loci::memory::belief
