#pragma once

#include <array>
#include <cmath>
#include <numeric>

namespace loci::memory::belief {

/// Probabilities of factors on a stated scale before anything is known: normal in the logarithm, with
/// standard deviation `spread`.
template <size_t N>
std::array<double, N> scale_prior(const std::array<double, N>& factors, double spread) {
  std::array<double, N> weights{};
  for (size_t i = 0; i < N; ++i) {
    const double deviation = std::log(factors[i]) / spread;
    weights[i] = std::exp(-deviation * deviation / 2);
  }
  const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
  for (double& weight : weights) weight /= sum;
  return weights;
}

}  // namespace loci::memory::belief
