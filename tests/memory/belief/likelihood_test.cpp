#include "memory/belief/evidence/likelihood.h"

#include <gtest/gtest.h>

#include <cmath>

#include "mapping/base/math/random.h"

namespace loci::memory::belief {
namespace {

TEST(LogSame, IsALikelihoodRatioThatKnowsTheBorders) {
  // Averaged over all that the domain may hold, the ratio of densities is one.
  Random random(5);
  const double sigma = 0.1;
  double sum = 0;
  constexpr int kDraws = 200000;
  for (int i = 0; i < kDraws; ++i) {
    const double believed = 0.03;
    const double seen = random.uniform() + random.normal(sigma);
    sum += std::exp(log_same({believed, sigma * sigma}, {0, 1}, {seen, sigma * sigma}, {0, 1}));
  }
  EXPECT_NEAR(sum / kDraws, 1.0, 0.02);
}

}  // namespace
}  // namespace loci::memory::belief
