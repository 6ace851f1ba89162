#pragma once

#include "mapping/base/math/pose.h"
#include "mapping/base/math/random.h"
#include "mapping/base/options.h"
#include "mapping/sensor/scan.h"

namespace loci::mapping {

/// A planar laser on a tilt unit, and how it measures (defaults: Hokuyo UTM-30LX, the PR2's scanner).
/// The scanner frame stands level over the robot's base, `height_m` above the floor: x forward, z up; the
/// beam starts in its origin. Azimuth counts from x towards y, tilt from the horizon upwards.
struct LaserModel {
  double height_m = 1.25;
  double azimuth_range_deg = 180;
  double azimuth_step_deg = 0.25;
  double tilt_min_deg = -50;
  double tilt_max_deg = 45;
  double tilt_step_deg = 0.25;
  double range_min_m = 0.1;
  double range_max_m = 10;
  double range_sigma_m = 0.008;
  double beam_width_deg = 0.2;
  double mixed_spread_m = 0.05;
  double mixed_probability = 0.5;
  double glossy_incidence_max_deg = 80;
  double min_reflectance = 0.02;
  double intensity_sigma = 0.02;
  double color_sigma = 3;

  void declare(OptionTable& table);

  int azimuths() const;
  int tilts() const;
  /// Unit direction of a ray in the scanner frame.
  Vector3d direction(int azimuth, int tilt) const;
};

/// Where a robot's base is on the floor, map frame: metres, radians.
struct PlanarPose {
  double x = 0, y = 0, yaw = 0;
};

Isometry3d map_from_base(const PlanarPose& pose);
/// x, y and yaw of a pose; what it has of roll, pitch and height is dropped.
PlanarPose planar(const Isometry3d& pose);

/// How a wheeled base mis-measures its own motion: per move of length L (m) and turn A (deg), x and y get
/// N(0, position_per_m · L), yaw gets N(0, yaw_deg_per_m · L + yaw_per_turn · A).
struct OdometryModel {
  double position_per_m = 0.03;
  double yaw_deg_per_m = 0.5;
  double yaw_per_turn = 0.02;

  void declare(OptionTable& table);

  /// The relative motion as the robot believes it, from the true one.
  Isometry3d measured(const Isometry3d& from_to, Random& random) const;
  /// Variances of that measurement (x y z roll pitch yaw; zero for z, roll, pitch).
  Eigen::Matrix<double, 6, 6> covariance(const Isometry3d& from_to) const;
};

}  // namespace loci::mapping
