#include "perception/classification/primitive_shape.h"
#include "mapping/base/math/math.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "mapping/base/math/random.h"

namespace loci::perception {
namespace {

using Kind = PrimitiveShape::Kind;

/// A camera that looks down on a table by 40 degrees: the table's frame has z up.
Isometry3d camera_from_table() {
  Isometry3d pose = Isometry3d::Identity();
  pose.linear() =
      (Eigen::AngleAxisd(40 * kPi / 180, Vector3d::UnitX()) * Eigen::AngleAxisd(kPi / 2, Vector3d::UnitX()))
          .toRotationMatrix();
  pose.translation() = Vector3d(0.02, 0.05, 1.0);
  return pose;
}

Ground ground() {
  const Isometry3d pose = camera_from_table();
  const Vector3d up = pose.linear().col(2);
  return {up, up.dot(pose.translation())};
}

/// Patches of a surface in the table's frame, those that face the camera, with noise.
class Seen {
 public:
  void add(const Vector3d& point, const Vector3d& normal) {
    const Isometry3d pose = camera_from_table();
    const Vector3d p = pose * point, n = pose.linear() * normal;
    if (n.dot(p) > -0.2 * p.norm()) return;
    surface_.points.emplace_back(
        (p + 0.001 * Vector3d(random_.normal(), random_.normal(), random_.normal())).cast<float>());
    surface_.normals.emplace_back((n + 0.05 * Vector3d(random_.normal(), random_.normal(), random_.normal()))
                                      .normalized()
                                      .cast<float>());
  }

  /// A round thing from z = 0 up, closed at the top, in a frame of the table.
  void add_round(const Isometry3d& frame, double low, double high, double height) {
    const double slope = (high - low) / height;
    for (double z = 0; z <= height; z += 0.003)
      for (double a = 0; a < 2 * kPi; a += 0.06) {
        const Vector3d out = Vector3d(std::cos(a), std::sin(a), -slope).normalized();
        const double radius = low + slope * z;
        add(frame * Vector3d(radius * std::cos(a), radius * std::sin(a), z), frame.linear() * out);
      }
    for (double x = -high; x <= high; x += 0.003)
      for (double y = -high; y <= high; y += 0.003)
        if (std::hypot(x, y) < high) add(frame * Vector3d(x, y, height), frame.linear().col(2));
  }

  const SurfacePoints& surface() const { return surface_; }

 private:
  SurfacePoints surface_;
  Random random_{3};
};

Isometry3d at(double x, double y, double yaw = 0) {
  Isometry3d pose(Eigen::Translation3d(x, y, 0));
  pose.rotate(Eigen::AngleAxisd(yaw, Vector3d::UnitZ()));
  return pose;
}

TEST(PrimitiveShape, a_box_has_its_edges_and_its_yaw) {
  Seen seen;
  const Isometry3d frame = at(0.05, 0.1, 0.5);
  const Vector3d size(0.2, 0.08, 0.12);
  for (int axis = 0; axis < 3; ++axis)
    for (const double side : {-1.0, 1.0})
      for (double a = -0.5; a <= 0.5; a += 0.02)
        for (double b = -0.5; b <= 0.5; b += 0.02) {
          Vector3d point, normal = Vector3d::Zero();
          point[axis] = side / 2;
          point[(axis + 1) % 3] = a;
          point[(axis + 2) % 3] = b;
          normal[axis] = side;
          point = point.cwiseProduct(size) + Vector3d(0, 0, size.z() / 2);
          seen.add(frame * point, frame.linear() * normal);
        }
  const auto shape = fit_primitive(seen.surface(), ground());
  ASSERT_TRUE(shape);
  EXPECT_EQ(shape->kind, Kind::box);
  EXPECT_NEAR(shape->size.z(), 0.12, 0.004);
  const auto [shorter, longer] = std::minmax({shape->size.x(), shape->size.y()});
  EXPECT_NEAR(longer, 0.2, 0.006);
  EXPECT_NEAR(shorter, 0.08, 0.006);
  const Vector3d edge = (camera_from_table().inverse() * shape->frame_from_shape).linear().col(0);
  EXPECT_NEAR(std::remainder(std::atan2(edge.y(), edge.x()) - 0.5, kPi / 2), 0, 0.05);
  EXPECT_GT(shape->explained, 0.9);
  EXPECT_GT(shape->probability, 0.9);
}

TEST(PrimitiveShape, a_standing_cylinder_has_its_radius_and_reaches_the_ground) {
  Seen seen;
  seen.add_round(at(0.1, 0), 0.04, 0.04, 0.15);
  const auto shape = fit_primitive(seen.surface(), ground());
  ASSERT_TRUE(shape);
  EXPECT_EQ(shape->kind, Kind::cylinder);
  EXPECT_NEAR(shape->radius(), 0.04, 0.002);
  EXPECT_NEAR(shape->size.z(), 0.15, 0.004);
  const Vector3d centre = camera_from_table().inverse() * shape->frame_from_shape.translation();
  EXPECT_NEAR((centre - Vector3d(0.1, 0, 0.075)).norm(), 0, 0.005);
}

TEST(PrimitiveShape, a_cup_that_widens_is_a_cone) {
  Seen seen;
  seen.add_round(at(0, 0), 0.03, 0.05, 0.1);
  const auto shape = fit_primitive(seen.surface(), ground());
  ASSERT_TRUE(shape);
  EXPECT_EQ(shape->kind, Kind::cone);
  EXPECT_NEAR(shape->radius_low, 0.03, 0.003);
  EXPECT_NEAR(shape->radius_high, 0.05, 0.003);
}

TEST(PrimitiveShape, a_lying_cylinder_has_its_axis_along_the_table) {
  Seen seen;
  Isometry3d frame = at(0, 0, 0.6);
  frame.translate(Vector3d(-0.1, 0, 0.035));
  frame.rotate(Eigen::AngleAxisd(kPi / 2, Vector3d::UnitY()));
  seen.add_round(frame, 0.035, 0.035, 0.2);
  const auto shape = fit_primitive(seen.surface(), ground());
  ASSERT_TRUE(shape);
  EXPECT_EQ(shape->kind, Kind::cylinder);
  EXPECT_NEAR(shape->radius(), 0.035, 0.003);
  EXPECT_NEAR(shape->size.z(), 0.2, 0.008);
  const Vector3d axis = (camera_from_table().inverse() * shape->frame_from_shape).linear().col(2);
  EXPECT_GT(std::abs(axis.dot(Vector3d(std::cos(0.6), std::sin(0.6), 0))), 0.997);
}

TEST(PrimitiveShape, a_ball_has_its_radius) {
  Seen seen;
  for (double polar = 0.02; polar < kPi; polar += 0.05)
    for (double a = 0; a < 2 * kPi; a += 0.06) {
      const Vector3d out(std::sin(polar) * std::cos(a), std::sin(polar) * std::sin(a), std::cos(polar));
      seen.add(0.06 * out + Vector3d(0, 0, 0.06), out);
    }
  const auto shape = fit_primitive(seen.surface(), ground());
  ASSERT_TRUE(shape);
  EXPECT_EQ(shape->kind, Kind::sphere);
  EXPECT_NEAR(shape->radius(), 0.06, 0.002);
  EXPECT_LT(shape->error, 0.003);
}

TEST(PrimitiveShape, few_points_or_none_with_a_normal_have_no_shape) {
  EXPECT_FALSE(fit_primitive({}, ground()));
  SurfacePoints surface;
  for (int i = 0; i < 100; ++i) {
    surface.points.emplace_back(0.001f * static_cast<float>(i), 0.0f, 1.0f);
    surface.normals.emplace_back(Eigen::Vector3f::Constant(std::nanf("")));
  }
  EXPECT_FALSE(fit_primitive(surface, ground()));
  surface.normals.assign(100, Eigen::Vector3f(0, 0, -1));
  fit_primitive(surface, ground());  // A line: whatever it is, it ends.
}

}  // namespace
}  // namespace loci::perception
