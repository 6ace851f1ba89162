#include "mapping/simulation/laser_sweep.h"
#include "mapping/base/math/math.h"

#include <gtest/gtest.h>

#include <cmath>

#include "mapping/world/urdf.h"

namespace loci::mapping {
namespace {

/// A box with its middle at `origin` and a material of that name and colour.
std::string block(const std::string& name, const std::string& size, const std::string& origin,
                  const std::string& material, const std::string& rgba) {
  return "<link name=\"" + name + "\"><visual><origin xyz=\"" + origin + "\"/><geometry><box size=\"" + size +
         "\"/></geometry><material name=\"" + material + "\"><color rgba=\"" + rgba +
         "\"/></material></visual></link><joint name=\"" + name +
         "_joint\" type=\"fixed\"><parent link=\"map\"/><child link=\"" + name + "\"/></joint>";
}

RayScene scene_of(const std::string& blocks) {
  RayScene scene;
  Warnings warnings;
  scene.add(parse_urdf("<robot name=\"w\"><link name=\"map\"/>" + blocks + "</robot>", "test.urdf"), {},
            Isometry3d::Identity(), warnings);
  return scene;
}

/// A wall across x, its face at `x`.
RayScene wall_at(double x, const std::string& rgba, const std::string& material = "paint") {
  return scene_of(block("wall", "1 100 100", std::to_string(x + 0.5) + " 0 0", material, rgba));
}

/// Only the beams around straight ahead, so that a wall is hit nearly upright.
LaserModel narrow() {
  LaserModel laser;
  laser.azimuth_range_deg = 4;
  laser.azimuth_step_deg = 0.04;
  laser.tilt_min_deg = -2;
  laser.tilt_max_deg = 2;
  laser.tilt_step_deg = 0.04;
  return laser;
}

/// One beam per tilt in a level plane, without any noise.
LaserModel exact() {
  LaserModel laser;
  laser.range_sigma_m = laser.intensity_sigma = laser.color_sigma = 0;
  return laser;
}

Scan sweep(const RayScene& scene, const LaserModel& laser, uint64_t seed = 1, int threads = 2) {
  return simulate_sweep(scene, Isometry3d::Identity(), laser, Random(seed), threads);
}

struct Moments {
  double mean = 0, sigma = 0;
};

template <class Value>
Moments moments(const Scan& scan, const Value& value) {
  double sum = 0, squares = 0;
  for (const ScanPoint& point : scan.points) sum += value(point);
  const double count = static_cast<double>(scan.points.size()), mean = sum / count;
  for (const ScanPoint& point : scan.points) squares += std::pow(value(point) - mean, 2);
  return {mean, std::sqrt(squares / count)};
}

TEST(LaserSweep, HasOneReturnPerRayInAClosedRoom) {
  Scan scan = sweep(scene_of(block("room", "8 8 3", "0 0 0.5", "paint", "0.8 0.8 0.8 1")), LaserModel{});
  EXPECT_EQ(scan.points.size(), 721u * 381u);
  for (const ScanPoint& point : scan.points) ASSERT_TRUE(point.returned);
  EXPECT_EQ(scan.origins.size(), 1u);
}

TEST(LaserSweep, RangeNoiseHasThePinnedSpreadAndNoBias) {
  const Scan scan = sweep(wall_at(3, "0.5 0.5 0.5 1"), narrow());
  ASSERT_EQ(scan.points.size(), 101u * 101u);
  const Moments range_error = moments(scan, [](const ScanPoint& p) {
    const double range = static_cast<double>(p.position.norm());
    return range - 3 * range / static_cast<double>(p.position.x());
  });
  EXPECT_NEAR(range_error.mean, 0, 5 * 0.008 / 101);
  EXPECT_NEAR(range_error.sigma, 0.008, 0.0003);
}

TEST(LaserSweep, IntensityIsReflectanceTimesCosineWithNoise) {
  const Scan scan = sweep(wall_at(3, "0.4 0.6 0.2 1"), narrow());
  const double reflectance = 0.2126 * 0.4 + 0.7152 * 0.6 + 0.0722 * 0.2;
  const Moments intensity = moments(scan, [](const ScanPoint& p) { return p.intensity; });
  EXPECT_NEAR(intensity.mean, reflectance, 0.002);
  EXPECT_NEAR(intensity.sigma, 0.02, 0.001);
  const Moments green = moments(scan, [](const ScanPoint& p) { return p.g; });
  EXPECT_NEAR(green.mean, 153, 0.2);
  EXPECT_NEAR(green.sigma, 3, 0.15);
  // Aslant: a ray at 60 degrees.
  const Scan slanted = sweep(wall_at(1, "1 1 1 1"), exact());
  const LaserModel laser;
  size_t checked = 0;
  for (const ScanPoint& point : slanted.points) {
    if (!point.returned) continue;
    EXPECT_NEAR(point.intensity, point.position.normalized().x(), 0.01);
    ++checked;
  }
  EXPECT_GT(checked, 1000u);
}

TEST(LaserSweep, RayWithoutReturnStandsAtTheLargestRange) {
  const Scan scan = sweep(wall_at(12, "1 1 1 1"), LaserModel{});
  ASSERT_EQ(scan.points.size(), 721u * 381u);
  for (const ScanPoint& point : scan.points) {
    ASSERT_FALSE(point.returned);
    ASSERT_NEAR(point.position.norm(), 10, 1e-5);
  }
}

TEST(LaserSweep, WhatIsTooNearIsLeftOut) {
  EXPECT_TRUE(sweep(wall_at(0.08, "1 1 1 1"), narrow()).points.empty());
}

TEST(LaserSweep, DarkSurfacesReturnNothing) {
  for (const ScanPoint& point : sweep(wall_at(3, "0.015 0.015 0.015 1"), narrow()).points)
    ASSERT_FALSE(point.returned);
  // A grey of 0.1 disappears where the cosine falls below 0.2.
  for (const ScanPoint& point : sweep(wall_at(1, "0.1 0.1 0.1 1"), exact()).points) {
    const double cosine = static_cast<double>(point.position.normalized().x());
    if (std::abs(cosine - 0.2) > 0.01) {
      ASSERT_EQ(point.returned, cosine > 0.2) << cosine;
    }
  }
}

TEST(LaserSweep, GlossySurfacesReturnNothingBeyondTheirAngle) {
  int beyond = 0;
  for (const auto& [material, glossy] : {std::pair("window_glass", true), std::pair("paint", false)})
    for (const ScanPoint& point : sweep(wall_at(0.5, "1 1 1 1", material), exact()).points) {
      const double angle = std::acos(static_cast<double>(point.position.normalized().x())) / kDegree;
      if (angle > 80.2 && angle < 86) {
        ASSERT_EQ(point.returned, !glossy) << angle;
        ++beyond;
      } else if (angle < 79.8) {
        ASSERT_TRUE(point.returned) << angle;
      }
    }
  EXPECT_GT(beyond, 1000);
}

TEST(LaserSweep, EdgesGiveMixedReturnsHalfOfTheTime) {
  // A board at 2 m whose edge runs through the middle of a column of beams, a wall at 4 m.
  const RayScene scene = scene_of(block("board", "0.02 10 100", "2.01 5 0", "paint", "1 1 1 1") +
                                  block("wall", "1 100 100", "4.5 0 0", "paint", "1 1 1 1"));
  LaserModel laser = exact();
  laser.azimuth_range_deg = 1;
  laser.tilt_min_deg = -10;
  laser.tilt_max_deg = 10;
  laser.tilt_step_deg = 0.01;
  int mixed = 0, near = 0;
  for (const ScanPoint& point : sweep(scene, laser).points) {
    if (std::abs(point.position.y()) > 1e-4f) continue;  // Azimuth 0: the edge.
    const float along = point.position.x();
    (along > 2.1f && along < 3.9f ? mixed : near) += 1;
    if (along < 2.1f) {
      EXPECT_NEAR(along, 2, 0.01);
    }
  }
  ASSERT_EQ(mixed + near, 2001);
  EXPECT_NEAR(mixed, 1000, 4 * std::sqrt(2001 * 0.25));
}

TEST(LaserSweep, FloorsFarAwayAreNotLifted) {
  // Beams at grazing incidence see a range of floor: their mean is not nearer than their middle.
  const RayScene scene = scene_of(block("floor", "100 100 1", "0 0 -1.75", "paint", "1 1 1 1"));
  double sum = 0;
  int count = 0;
  for (const ScanPoint& point : sweep(scene, exact()).points) {
    const double distance = static_cast<double>(point.position.norm());
    if (!point.returned || distance < 3.5 || distance > 4.5) continue;
    sum += static_cast<double>(point.position.z()) + 1.25;
    ++count;
  }
  ASSERT_GT(count, 1000);
  EXPECT_NEAR(sum / count, 0, 0.001);
}

TEST(LaserSweep, SameSeedSameBytesOnAnyNumberOfThreads) {
  const RayScene scene = scene_of(block("room", "8 8 3", "0 0 0.5", "paint", "0.8 0.8 0.8 1"));
  LaserModel laser;
  laser.tilt_step_deg = 2;
  const Scan one = sweep(scene, laser, 9, 1);
  for (const int threads : {2, 3, 7}) {
    const Scan many = sweep(scene, laser, 9, threads);
    ASSERT_EQ(one.points.size(), many.points.size());
    for (size_t i = 0; i < one.points.size(); ++i) {
      ASSERT_EQ(one.points[i].position, many.points[i].position);
      ASSERT_EQ(one.points[i].intensity, many.points[i].intensity);
      ASSERT_EQ(one.points[i].g, many.points[i].g);
    }
  }
  EXPECT_NE(one.points[5].position, sweep(scene, laser, 10, 1).points[5].position);
}

}  // namespace
}  // namespace loci::mapping
