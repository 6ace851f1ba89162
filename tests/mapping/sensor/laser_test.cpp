#include "mapping/sensor/laser.h"
#include "mapping/base/math/math.h"

#include <gtest/gtest.h>

#include <cmath>

namespace loci::mapping {
namespace {

TEST(Laser, PinnedNumbersAreTheDefaults) {
  const LaserModel laser;
  EXPECT_EQ(laser.height_m, 1.25);
  EXPECT_EQ(laser.azimuths(), 721);
  EXPECT_EQ(laser.tilts(), 381);
  EXPECT_EQ(laser.range_sigma_m, 0.008);
  EXPECT_EQ(laser.range_min_m, 0.1);
  EXPECT_EQ(laser.range_max_m, 10);
  const OdometryModel odometry;
  EXPECT_EQ(odometry.position_per_m, 0.03);
  EXPECT_EQ(odometry.yaw_deg_per_m, 0.5);
  EXPECT_EQ(odometry.yaw_per_turn, 0.02);
}

TEST(Laser, DirectionsSpanTheFieldOfView) {
  const LaserModel laser;
  EXPECT_LT((laser.direction(360, 200) - Vector3d::UnitX()).norm(), 1e-12);
  EXPECT_LT((laser.direction(720, 200) - Vector3d::UnitY()).norm(), 1e-12);
  EXPECT_LT((laser.direction(0, 200) + Vector3d::UnitY()).norm(), 1e-12);
  EXPECT_NEAR(laser.direction(360, 0).z(), -std::sin(50 * kDegree), 1e-12);
  EXPECT_NEAR(laser.direction(100, 380).z(), std::sin(45 * kDegree), 1e-12);
  EXPECT_NEAR(laser.direction(17, 33).norm(), 1, 1e-12);
}

TEST(Laser, PlanarPoseSurvivesTheRoundTrip) {
  const PlanarPose pose = planar(map_from_base({1.5, -2, 2.8}));
  EXPECT_NEAR(pose.x, 1.5, 1e-12);
  EXPECT_NEAR(pose.y, -2, 1e-12);
  EXPECT_NEAR(pose.yaw, 2.8, 1e-12);
}

TEST(Odometry, ErrorsHaveThePinnedSpread) {
  const OdometryModel odometry;
  const Isometry3d motion = map_from_base({1.6, 1.2, 90 * kDegree});  // 2 m, 90 degrees.
  const double position_sigma = 0.03 * 2, yaw_sigma = (0.5 * 2 + 0.02 * 90) * kDegree;
  Random random(5);
  const int count = 20000;
  double x = 0, xx = 0, yy = 0, yaw = 0, yaw_yaw = 0;
  for (int i = 0; i < count; ++i) {
    const PlanarPose error = planar(odometry.measured(motion, random));
    x += error.x - 1.6;
    xx += std::pow(error.x - 1.6, 2);
    yy += std::pow(error.y - 1.2, 2);
    yaw += error.yaw - 90 * kDegree;
    yaw_yaw += std::pow(error.yaw - 90 * kDegree, 2);
  }
  EXPECT_NEAR(x / count, 0, 4 * position_sigma / std::sqrt(count));
  EXPECT_NEAR(yaw / count, 0, 4 * yaw_sigma / std::sqrt(count));
  EXPECT_NEAR(std::sqrt(xx / count), position_sigma, 0.02 * position_sigma);
  EXPECT_NEAR(std::sqrt(yy / count), position_sigma, 0.02 * position_sigma);
  EXPECT_NEAR(std::sqrt(yaw_yaw / count), yaw_sigma, 0.02 * yaw_sigma);
  const Eigen::Matrix<double, 6, 6> covariance = odometry.covariance(motion);
  EXPECT_NEAR(covariance(0, 0), position_sigma * position_sigma, 1e-12);
  EXPECT_NEAR(covariance(5, 5), yaw_sigma * yaw_sigma, 1e-12);
}

TEST(Odometry, StandingStillIsExact) {
  Random random(1);
  const Isometry3d still = OdometryModel{}.measured(Isometry3d::Identity(), random);
  EXPECT_TRUE(still.isApprox(Isometry3d::Identity(), 1e-15));
  EXPECT_TRUE(OdometryModel{}.covariance(Isometry3d::Identity()).isZero(0));
}

}  // namespace
}  // namespace loci::mapping
