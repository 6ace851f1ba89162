#include "perception/types/geometry.h"

#include <gtest/gtest.h>

namespace loci::perception::types {
namespace {

Isometry3d some_pose() {
  Isometry3d pose = Isometry3d::Identity();
  pose.translate(Vector3d(1, -2, 3));
  pose.rotate(Eigen::AngleAxisd(2.5, Vector3d(1, 2, -1).normalized()));
  return pose;
}

TEST(EigenConversion, PosesComeBack) {
  cas::Cas cas(type_system());
  EXPECT_TRUE(from<Isometry3d>(to(cas, some_pose())).isApprox(some_pose(), 1e-12));
  EXPECT_EQ(from<Vector3d>(to(cas, Vector3d(1, 2, 3))), Vector3d(1, 2, 3));
  const Eigen::Quaterniond rotation(some_pose().rotation());
  EXPECT_TRUE(from<Eigen::Quaterniond>(to(cas, rotation)).isApprox(rotation));
}

TEST(EigenConversion, AStampedTransformIsATransform) {
  cas::Cas cas(type_system());
  const StampedTransform stamped = to_stamped(cas, some_pose(), "map", "camera", 17);
  EXPECT_TRUE(from<Isometry3d>(stamped).isApprox(some_pose(), 1e-12));
  EXPECT_EQ(stamped.child_frame_id.get(), "camera");
  EXPECT_EQ(stamped.timestamp.get(), 17);
}

TEST(EigenConversion, AMissingPoseIsAnErrorNotTheIdentity) {
  cas::Cas cas(type_system());
  EXPECT_THROW(from<Isometry3d>(Transform()), Error);
  EXPECT_THROW(from<Isometry3d>(Transform::create(cas)), Error);
}

TEST(EigenConversion, OutlinesComeBack) {
  const std::vector<Vector3d> outline = {{0, 0, 1}, {1, 0, 1}, {1, 1, 1}};
  const cas::Buffer<double> values(values_from_points(outline));
  EXPECT_EQ(points_from_values(values), outline);
  EXPECT_THROW(points_from_values(cas::Buffer<double>(std::vector<double>(4))), Error);
}

}  // namespace
}  // namespace loci::perception::types
