#include "mapping/simulation/walk.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <filesystem>

#include "mapping/base/math/math.h"
#include "mapping/world/urdf.h"
#include "tests/mapping/simulation/samples.h"

namespace loci::mapping {
namespace {

TEST(Walk, StaysInsideAndTurnsRound) {
  Warnings warnings;
  const std::vector<Isometry3d> views =
      views_from(standing_places(read_urdf(kSamples / "kitchen.urdf"), {{}, kSamples}, warnings));
  ASSERT_GE(views.size(), 72U);
  std::array<int, 4> quarters{};
  for (const Isometry3d& view : views) {
    const Vector3d from = view.translation(), forward = view.linear().col(2);
    EXPECT_TRUE(from.x() > 0.2 && from.x() < 3.8 && from.y() > 0.2 && from.y() < 2.8) << from.transpose();
    EXPECT_TRUE(from.z() > 0.8 && from.z() < 1.6);
    EXPECT_GT(view.linear().col(1).dot(-Vector3d::UnitZ()), 0.8) << "upright";
    ++quarters[(forward.x() > 0 ? 1 : 0) + (forward.y() > 0 ? 2 : 0)];
  }
  for (const int quarter : quarters) EXPECT_GE(quarter, static_cast<int>(views.size()) / 6);
}

TEST(Walk, AStrollIsAVideo) {
  Random random(1);
  const std::vector<Isometry3d> views = stroll({{1, 1}, {1.8, 1}}, random);
  ASSERT_GT(views.size(), 200U);
  for (size_t i = 1; i < views.size(); ++i) {
    const Isometry3d motion = views[i - 1].inverse() * views[i];
    EXPECT_LT(motion.translation().norm(), 0.025) << i;
    EXPECT_LT(Eigen::AngleAxisd(motion.linear()).angle(), 4 * kDegree) << i;
  }
  EXPECT_GT((views.front().translation() - views.back().translation()).norm(), 0.5);
}

TEST(Walk, NeedsAPlaceToStand) {
  World world;
  world.name = world.root = "map";
  world.links.push_back({.name = "map", .visuals = {}, .collisions = {}, .inertial = {}});
  Warnings warnings;
  EXPECT_THROW(standing_places(world, {}, warnings), Error);
}

}  // namespace
}  // namespace loci::mapping
