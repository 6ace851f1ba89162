#include "mapping/sensor/pose_text.h"
#include "mapping/base/math/math.h"

#include <gtest/gtest.h>

#include "mapping/base/error.h"

namespace loci::mapping {
namespace {

TEST(PoseText, ReadsPosesInDegrees) {
  const std::vector<PlanarPose> poses = planar_poses_from("1,2.5,90; -1, 0, -45 ;", "--poses");
  ASSERT_EQ(poses.size(), 2U);
  EXPECT_EQ(poses[0].x, 1);
  EXPECT_EQ(poses[0].y, 2.5);
  EXPECT_NEAR(poses[0].yaw, kPi / 2, 1e-12);
  EXPECT_NEAR(poses[1].yaw, -kPi / 4, 1e-12);
}

TEST(PoseText, RefusesWhatIsNoPose) {
  for (const char* text : {"", ";", "1,2", "1,2,3,4", "1,two,3", "1,2,3x"})
    EXPECT_THROW(planar_poses_from(text, "--poses"), Error) << text;
}

}  // namespace
}  // namespace loci::mapping
