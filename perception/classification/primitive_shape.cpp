#include "perception/classification/primitive_shape.h"

#include <algorithm>
#include <cmath>

#include "mapping/base/math.h"
#include "mapping/base/quantile.h"
#include "perception/classification/primitive_fits.h"

namespace loci::perception {
namespace {

using namespace primitive_fits;
using Kind = PrimitiveShape::Kind;

constexpr size_t kMinPoints = 30;
constexpr size_t kMaxPoints = 800;
// So many points speak for themselves: the errors of neighbours are alike.
constexpr double kIndependent = 60;

double numbers_of(Kind kind) {
  switch (kind) {
    case Kind::box:
      return 6;  // place, yaw, edges
    case Kind::cylinder:
      return 5;
    case Kind::cone:
      return 6;
    default:
      return 3;
  }
}

/// Points and normals above the ground, about the middle of the points.
primitive_fits::Samples samples_of(const SurfacePoints& surface, const Eigen::Matrix3d& upright,
                                   const Vector3d& origin, const PrimitiveOptions& options) {
  primitive_fits::Samples samples;
  const size_t step = std::max<size_t>(1, surface.points.size() / kMaxPoints);
  std::vector<double> heights;
  double distance = 0;
  for (size_t i = 0; i < surface.points.size(); i += step) {
    const Eigen::Vector3f& normal = surface.normals[i];
    if (!surface.points[i].allFinite() || !normal.allFinite() || normal.squaredNorm() < 0.25f) continue;
    samples.points.emplace_back(upright * (surface.points[i].cast<double>() - origin));
    samples.normals.emplace_back(upright * normal.cast<double>().normalized());
    heights.push_back(samples.points.back().z());
    distance += surface.points[i].cast<double>().norm();
  }
  if (samples.points.size() < kMinPoints) return {};
  distance /= static_cast<double>(samples.points.size());
  samples.sigma_m = options.noise_m + options.noise_per_m2 * distance * distance;
  samples.sigma_angle = options.normal_deg * kPi / 180;
  const double lowest = quantile(heights, 0.005);
  samples.grounded = lowest < options.ground_m;
  samples.base = samples.grounded ? 0 : lowest;
  return samples;
}

}  // namespace

std::string name_of(PrimitiveShape::Kind kind) {
  switch (kind) {
    case Kind::box:
      return "box";
    case Kind::cylinder:
      return "cylinder";
    case Kind::cone:
      return "cone";
    default:
      return "sphere";
  }
}

void PrimitiveOptions::declare(OptionTable& table) {
  table.number("noise_m", noise_m, "m", "Scatter of points about a surface.", 0.0001, 0.1);
  table.number("noise_per_m2", noise_per_m2, "1/m", "What is added a metre away; grows with the square.", 0,
               0.1);
  table.number("normal_deg", normal_deg, "deg", "Scatter of normals.", 1, 90);
  table.number("ground_m", ground_m, "m", "What ends this near above its support reaches down to it.", 0, 1);
}

std::optional<PrimitiveShape> fit_primitive(const SurfacePoints& surface, const Ground& ground,
                                            const PrimitiveOptions& options) {
  if (surface.points.size() != surface.normals.size()) throw Error("points and normals are not as many");
  Vector3d middle = Vector3d::Zero();
  double count = 0;
  for (const Eigen::Vector3f& point : surface.points)
    if (point.allFinite()) {
      middle += point.cast<double>();
      ++count;
    }
  if (count < static_cast<double>(kMinPoints)) return std::nullopt;
  middle /= count;
  const Vector3d up = ground.up.normalized();
  const Vector3d origin = middle - (up.dot(middle) - ground.height / ground.up.norm()) * up;
  const Eigen::Matrix3d upright =
      Eigen::Quaterniond::FromTwoVectors(up, Vector3d::UnitZ()).toRotationMatrix();
  const primitive_fits::Samples samples = samples_of(surface, upright, origin, options);
  if (samples.points.empty()) return std::nullopt;

  std::vector<PrimitiveShape> shapes;
  for (const auto& fitted :
       {fit_boxes(samples), fit_standing(samples), fit_lying(samples), fit_spheres(samples)})
    shapes.insert(shapes.end(), fitted.begin(), fitted.end());
  std::vector<double> scores;
  for (const PrimitiveShape& shape : shapes)
    scores.push_back(
        -0.5 * (kIndependent * cost_of(shape, samples) + numbers_of(shape.kind) * std::log(kIndependent)));
  const size_t best = static_cast<size_t>(std::max_element(scores.begin(), scores.end()) - scores.begin());
  PrimitiveShape shape = shapes[best];
  double others = 0;  // Of each other kind its best fit counts.
  for (const Kind kind : {Kind::box, Kind::cylinder, Kind::cone, Kind::sphere}) {
    double most = -1e300;
    for (size_t i = 0; i < shapes.size(); ++i)
      if (shapes[i].kind == kind) most = std::max(most, scores[i]);
    if (kind != shape.kind) others += std::exp(most - scores[best]);
  }
  shape.probability = 1 / (1 + others);
  judge(shape, samples);
  Isometry3d frame_from_upright = Isometry3d::Identity();
  frame_from_upright.linear() = upright.transpose();
  frame_from_upright.translation() = origin;
  shape.frame_from_shape = frame_from_upright * shape.frame_from_shape;
  return shape;
}

}  // namespace loci::perception
