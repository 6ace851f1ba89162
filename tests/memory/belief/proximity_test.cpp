#include "memory/belief/evidence/proximity.h"

#include <gtest/gtest.h>

namespace loci::memory::belief {
namespace {

TEST(Proximity, TwoPartsOfAnObjectMayLieOnEitherSideOfWhatHidesIt) {
  const PositionNoise noise{1e-4, 1e-5, NoiseScale().weights(0.5)};
  const AxisBox left{{-0.04, 0, 0}, {0.12, 0.04, 0.04}};
  Observation right;
  right.box = {{0.065, 0, 0}, {0.07, 0.04, 0.04}};
  BeliefOptions options;
  options.area_m2 = 1;

  EXPECT_LT(log_proximity(left, noise, true, right, options), 0) << "seen whole, it is another one";
  right.partial = true;
  EXPECT_GT(log_proximity(left, noise, true, right, options), 0);
  right.box.centre.x() += 0.3;
  EXPECT_LT(log_proximity(left, noise, true, right, options), 0) << "too far for one object";
}

}  // namespace
}  // namespace loci::memory::belief
