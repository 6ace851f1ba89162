#include "memory/belief/evidence/likelihood.h"

#include <algorithm>
#include <cmath>

#include "mapping/base/math/math.h"

namespace loci::memory::belief {

double mass(const Measured& number, const Domain& domain) {
  constexpr double kMin = 1e-12;
  const double scale = 1 / std::sqrt(2 * number.variance);
  const double high = (domain.high - number.mean) * scale, low = (domain.low - number.mean) * scale;
  constexpr double kAll = 6;  // beyond it erfc() is below the precision of its sum
  if (low < -kAll && high > kAll) return 1;
  // The difference of two tails is only exact where both are small.
  const double inside = low > 0 ? std::erfc(low) - std::erfc(high) : std::erfc(-high) - std::erfc(-low);
  return std::max(kMin, 0.5 * inside);
}

double log_same(const Measured& believed, const Domain& possible, const Measured& seen,
                const Domain& visible) {
  const double sum = believed.variance + seen.variance;
  const double difference = seen.mean - believed.mean;
  const Measured fused{(believed.mean * seen.variance + seen.mean * believed.variance) / sum,
                       believed.variance * seen.variance / sum};
  const double log_gaussian = -0.5 * (std::log(2 * kPi * sum) + difference * difference / sum);
  return log_gaussian + std::log(mass(fused, visible) / (mass(believed, possible) * mass(seen, visible)));
}

}  // namespace loci::memory::belief
