#include <gtest/gtest.h>

#include "mapping/base/math/random.h"
#include "memory/belief/evidence/proximity.h"

namespace loci::memory::belief {
namespace {

/// Counts horizontal offsets of a standard deviation, where the options state 1 m.
NoiseScale learned(double sigma, int offsets, double spread) {
  NoiseScale scale;
  Random random(5);
  const PositionNoise stated{0, 1, {}};
  for (int i = 0; i < offsets; ++i) {
    const double x = random.normal(sigma), y = random.normal(sigma);
    scale.count(stated.densities(x * x + y * y), 1, spread);
  }
  return scale;
}

TEST(NoiseScale, FindsTheTrueNoise) {
  for (const double sigma : {0.2, 0.5, 1.0, 2.0})
    EXPECT_NEAR(std::sqrt(learned(sigma, 400, 0.7).variance_factor(0.7)) / sigma, 1, 0.35) << sigma;
}

TEST(NoiseScale, WithoutEvidenceIsWhatTheOptionsState) {
  EXPECT_NEAR(NoiseScale().variance_factor(0.3), 1, 0.05);
}

TEST(NoiseScale, MainWeightsAreThoseNearTheMean) {
  const NoiseScale scale = learned(0.5, 100, 0.7);
  double sum = 0;
  const NoiseScale::Levels main = scale.main_weights(0.7);
  for (size_t i = 0; i < NoiseScale::kLevels; ++i) {
    sum += main[i];
    const double factor = NoiseScale::kFactors[i];
    EXPECT_TRUE(main[i] == 0 || (factor > 0.2 && factor < 1)) << factor;
  }
  EXPECT_NEAR(sum, 1, 1e-9);
}

TEST(NoiseScale, IsTheMoreTolerantTheLessIsKnown) {
  const double far = 16;  // squared offset of four standard deviations
  const auto density = [&](double spread) {
    return PositionNoise{0, 1, NoiseScale().weights(spread)}.log_density(far, 0);
  };
  EXPECT_GT(density(0.7), density(0.3));
  EXPECT_GT(density(0.3), density(0.1));
}

}  // namespace
}  // namespace loci::memory::belief
