#include "memory/belief/evidence/proximity.h"

#include <gtest/gtest.h>

#include <cmath>

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

/// A view shows an object but for a share of its depth, up to half of it.
TEST(Proximity, CentresFromTwoSidesDifferByWhatEitherDoesNotShow) {
  constexpr double kSize = 0.3;
  double opposite = 0, across = 0;  // squares: along the line of sight, and for one turned by 90 degrees
  constexpr int kSteps = 100;
  for (int i = 0; i < kSteps; ++i)
    for (int j = 0; j < kSteps; ++j) {
      const double first = kSize * (i + 0.5) / kSteps / 2, second = kSize * (j + 0.5) / kSteps / 2;
      opposite += std::pow((first + second) / 2, 2) / (kSteps * kSteps);
      across += std::pow(first / 2, 2) / (kSteps * kSteps);
    }
  BeliefOptions options;
  options.pose_noise_m = 0;
  Isometry3d from = Isometry3d::Identity(), to(Eigen::AngleAxisd(3, Vector3d::UnitZ()));
  to.translation().x() = 3;
  const double expected = std::sqrt((opposite + across) / 2);
  EXPECT_NEAR(std::sqrt(view_change_variance(from, to, kSize, options)), expected, expected / 10);
}

}  // namespace
}  // namespace loci::memory::belief
