#include "mapping/sensor/laser.h"

#include <cmath>

#include "mapping/base/math/math.h"

namespace loci::mapping {
namespace {

int steps(double range, double step) {
  return static_cast<int>(std::floor(range / step + 1e-6)) + 1;
}

double yaw_of(const Isometry3d& pose) {
  return std::atan2(pose.linear()(1, 0), pose.linear()(0, 0));
}

struct MotionSigma {
  double position, yaw;
};

MotionSigma sigma_of(const OdometryModel& model, const Isometry3d& from_to) {
  const double length = from_to.translation().head<2>().norm();
  const double turn = std::abs(yaw_of(from_to));
  return {model.position_per_m * length, model.yaw_deg_per_m * kDegree * length + model.yaw_per_turn * turn};
}

}  // namespace

void LaserModel::declare(OptionTable& table) {
  table.number("height_m", height_m, "m", "Height of the scanner over the floor.", 0.05, 5);
  table.number("azimuth_range_deg", azimuth_range_deg, "deg", "Width of a scan line.", 1, 360);
  table.number("azimuth_step_deg", azimuth_step_deg, "deg", "Between rays of a line.", 0.01, 10);
  table.number("tilt_min_deg", tilt_min_deg, "deg", "Lowest line, down is negative.", -90, 90);
  table.number("tilt_max_deg", tilt_max_deg, "deg", "Highest line.", -90, 90);
  table.number("tilt_step_deg", tilt_step_deg, "deg", "Between lines.", 0.01, 10);
  table.number("range_min_m", range_min_m, "m", "What is nearer is not measured.", 0, 10);
  table.number("range_max_m", range_max_m, "m", "What is farther gives no return.", 0.1, 200);
  table.number("range_sigma_m", range_sigma_m, "m", "Noise of a range.", 0, 1);
  table.number("beam_width_deg", beam_width_deg, "deg", "Width of a beam, five sub-rays across.", 0, 5);
  table.number("mixed_spread_m", mixed_spread_m, "m", "A beam that hits surfaces farther apart may mix them.",
               0.001, 10);
  table.number("mixed_probability", mixed_probability, "", "That it does.", 0, 1);
  table.number("glossy_incidence_max_deg", glossy_incidence_max_deg, "deg",
               "Glossy materials return nothing beyond this angle.", 0, 90);
  table.number("min_reflectance", min_reflectance, "",
               "Darker than this (reflectance times cosine of the incidence) returns nothing.", 0, 1);
  table.number("intensity_sigma", intensity_sigma, "", "Noise of an intensity.", 0, 1);
  table.number("color_sigma", color_sigma, "", "Noise of a colour, of 255.", 0, 255);
}

int LaserModel::azimuths() const {
  return steps(azimuth_range_deg, azimuth_step_deg);
}

int LaserModel::tilts() const {
  return steps(tilt_max_deg - tilt_min_deg, tilt_step_deg);
}

Vector3d LaserModel::direction(int azimuth, int tilt) const {
  const double a = (azimuth * azimuth_step_deg - azimuth_range_deg / 2) * kDegree;
  const double t = (tilt_min_deg + tilt * tilt_step_deg) * kDegree;
  return {std::cos(t) * std::cos(a), std::cos(t) * std::sin(a), std::sin(t)};
}

Isometry3d map_from_base(const PlanarPose& pose) {
  Isometry3d result = Isometry3d::Identity();
  result.translation() << pose.x, pose.y, 0;
  result.linear() = Eigen::AngleAxisd(pose.yaw, Vector3d::UnitZ()).toRotationMatrix();
  return result;
}

PlanarPose planar(const Isometry3d& pose) {
  return {pose.translation().x(), pose.translation().y(), yaw_of(pose)};
}

void OdometryModel::declare(OptionTable& table) {
  table.number("position_per_m", position_per_m, "", "Noise of x and y per metre driven.", 0, 1);
  table.number("yaw_deg_per_m", yaw_deg_per_m, "deg/m", "Noise of the yaw per metre driven.", 0, 90);
  table.number("yaw_per_turn", yaw_per_turn, "", "Noise of the yaw per angle turned.", 0, 1);
}

Isometry3d OdometryModel::measured(const Isometry3d& from_to, Random& random) const {
  const MotionSigma sigma = sigma_of(*this, from_to);
  const PlanarPose motion = planar(from_to);
  const double x = motion.x + random.normal(sigma.position);
  const double y = motion.y + random.normal(sigma.position);
  return map_from_base({x, y, motion.yaw + random.normal(sigma.yaw)});
}

Eigen::Matrix<double, 6, 6> OdometryModel::covariance(const Isometry3d& from_to) const {
  const MotionSigma sigma = sigma_of(*this, from_to);
  Eigen::Matrix<double, 6, 6> result = Eigen::Matrix<double, 6, 6>::Zero();
  result(0, 0) = result(1, 1) = sigma.position * sigma.position;
  result(5, 5) = sigma.yaw * sigma.yaw;
  return result;
}

}  // namespace loci::mapping
