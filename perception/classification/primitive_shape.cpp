#include "perception/classification/primitive_shape.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>

#include "mapping/base/math/eigenvalues.h"
#include "mapping/base/math/math.h"
#include "mapping/base/math/pose.h"

namespace loci::perception {
namespace {

/// Points and normals in a frame whose z axis is up and whose ground is z = 0.
struct Samples {
  std::vector<Vector3d> points, normals;
  double sigma_m = 0;      ///< noise of a point
  double sigma_angle = 0;  ///< of a normal, radian
  double base = 0;         ///< height at which the object begins
  bool grounded = false;   ///< whether that is the ground
};

/// How badly a shape explains the samples: mean squared distance and angle in standard deviations, each
/// sample's bounded by kWorst.
inline constexpr double kWorst = 9;

// Every fit of a kind that the samples allow; none when they do not show enough.
///< a cylinder and a cone
///< cylinders

using Kind = PrimitiveShape::Kind;
constexpr double kWall = 0.006;     // What is seen of the inside of a vessel lies this far within, m.
constexpr double kInside = 4;       // Cost of what lies within a vessel and faces up: its floor.
constexpr double kTail = 0.01;      // Share of the points beyond either end of what is seen.
constexpr double kMinSlope = 0.05;  // What widens by less is a cylinder as well as anybody can tell.
constexpr double kMinFace = 0.05;   // Share of the points that makes a face.

struct Misfit {
  double distance = 0, cosine = 1;
};

double cost(const Misfit& misfit, const Samples& samples) {
  const double angle = std::acos(std::clamp(misfit.cosine, -1.0, 1.0));
  return std::min(kWorst,
                  std::pow(misfit.distance / samples.sigma_m, 2) + std::pow(angle / samples.sigma_angle, 2));
}

double beyond(double value, double half) {
  return std::max(0.0, std::abs(value) - half);
}

/// The best of a box's faces for a point, both in the frame of the box.
Misfit on_box(const Vector3d& half, const Vector3d& point, const Vector3d& normal, const Samples& samples) {
  Misfit best{1, -1};
  double least = 2 * kWorst;
  for (int axis = 0; axis < 3; ++axis)
    for (const double side : {-1.0, 1.0}) {
      const int second = (axis + 1) % 3, third = (axis + 2) % 3;
      const Misfit misfit{std::hypot(point[axis] - side * half[axis], beyond(point[second], half[second]),
                                     beyond(point[third], half[third])),
                          side * normal[axis]};
      const double own = cost(misfit, samples);
      if (own < least) {
        least = own;
        best = misfit;
      }
    }
  return best;
}

/// The best of a cone's wall, ends and inside.
Misfit on_round(const PrimitiveShape& shape, const Vector3d& point, const Vector3d& normal,
                const Samples& samples) {
  const double height = shape.size.z(), slope = (shape.radius_high - shape.radius_low) / height;
  const double distance = point.head<2>().norm();
  const double radius =
      std::max(0.0, shape.radius() + slope * std::clamp(point.z(), -height / 2, height / 2));
  const double flank = 1 / std::hypot(1, slope);
  Vector3d outward = Vector3d::UnitZ();
  if (distance > 0) outward = flank * Vector3d(point.x() / distance, point.y() / distance, -slope);
  const double over = beyond(point.z(), height / 2);
  const double facing = normal.dot(outward);
  const double gap = facing < 0 ? std::max({0.0, distance - radius, radius - distance - kWall})
                                : std::abs(distance - radius);
  const Misfit wall{std::hypot(gap * flank, over), std::abs(facing)};
  const double aside = std::max(0.0, distance - radius);
  const Misfit top{std::hypot(point.z() - height / 2, aside), normal.z()};
  const Misfit bottom{std::hypot(point.z() + height / 2, aside), -normal.z()};
  Misfit best = wall;
  for (const Misfit& other : {top, bottom})
    if (cost(other, samples) < cost(best, samples)) best = other;
  return best;
}

double cost_at(const PrimitiveShape& shape, const Vector3d& point, const Vector3d& normal,
               const Samples& samples, Misfit& misfit) {
  switch (shape.kind) {
    case Kind::box:
      misfit = on_box(shape.size / 2, point, normal, samples);
      return cost(misfit, samples);
    case Kind::sphere:
      misfit = {std::abs(point.norm() - shape.radius_low), normal.dot(point.normalized())};
      return cost(misfit, samples);
    default: {
      misfit = on_round(shape, point, normal, samples);
      const double own = cost(misfit, samples);
      const bool floor = std::abs(point.z()) < shape.size.z() / 2 && normal.z() > 0.8 &&
                         point.head<2>().norm() < std::max(shape.radius_low, shape.radius_high);
      return floor ? std::min(own, kInside) : own;
    }
  }
}

template <class Visit>
void visit_samples(const PrimitiveShape& shape, const Samples& samples, const Visit& visit) {
  const Isometry3d shape_from_frame = shape.frame_from_shape.inverse();
  for (size_t i = 0; i < samples.points.size(); ++i) {
    Misfit misfit;
    const double own = cost_at(shape, shape_from_frame * samples.points[i],
                               shape_from_frame.linear() * samples.normals[i], samples, misfit);
    visit(own, misfit);
  }
}

double robust_weight(double squared) {
  return 1 / ((1 + squared) * (1 + squared));  // Geman and McClure.
}

/// A circle whose radius may change with `height`: points and normals in its plane.
struct Circle {
  Vector2d centre = Vector2d::Zero();
  double radius = 0, slope = 0;  ///< at height 0
};

struct CircleData {
  std::vector<Vector2d> points, normals;  ///< normals of length one
  std::vector<double> heights;
  double sigma_m = 0, sigma_angle = 0;
  bool on_ground = false;  ///< y of the centre is one radius
};

/// Gauss and Newton on distances and on how far normals point past the centre, reweighted.
std::optional<Circle> refine(const CircleData& data, Circle circle, bool with_slope) {
  constexpr int kRounds = 15;
  const int unknowns = with_slope ? 4 : 3;
  for (int round = 0; round < kRounds; ++round) {
    Eigen::Matrix4d system = Eigen::Matrix4d::Zero();
    Eigen::Vector4d right = Eigen::Vector4d::Zero();
    const auto add = [&](const Eigen::Vector4d& row, double residual, double weight) {
      system += weight * row * row.transpose();
      right -= weight * residual * row;
    };
    double all = 0;
    for (size_t i = 0; i < data.points.size(); ++i) {
      const Vector2d from = data.points[i] - circle.centre;
      const double distance = from.norm();
      if (distance < 1e-6) continue;
      const Vector2d& n = data.normals[i];
      const double inward = n.dot(from) < 0 ? kWall / 2 : 0;  // The inside of a vessel.
      const double off = distance + inward - circle.radius - circle.slope * data.heights[i];
      const double past = n.x() * from.y() - n.y() * from.x();
      const double past_sigma = data.sigma_angle * distance;
      const double weight = robust_weight(
          (off * off / (data.sigma_m * data.sigma_m) + past * past / (past_sigma * past_sigma)) / kWorst);
      add({-from.x() / distance, -from.y() / distance, -1, -data.heights[i]}, off,
          weight / (data.sigma_m * data.sigma_m));
      add({n.y(), -n.x(), 0, 0}, past, weight / (past_sigma * past_sigma));
      all += weight;
    }
    if (data.on_ground)
      add({0, 1, -1, 0}, circle.centre.y() - circle.radius, 0.2 * all / (data.sigma_m * data.sigma_m));
    system.diagonal() *= 1 + 1e-9;
    const Eigen::VectorXd step = system.topLeftCorner(unknowns, unknowns).ldlt().solve(right.head(unknowns));
    if (!step.allFinite()) return std::nullopt;
    circle.centre += step.head<2>();
    circle.radius += step[2];
    if (with_slope) circle.slope += step[3];
    if (step.norm() < 1e-6) break;
  }
  if (!(circle.radius >= 0.005 && circle.radius <= 0.5) || !circle.centre.allFinite()) return std::nullopt;
  return circle;
}

/// Where the lines along the normals meet; none when they are parallel.
std::optional<Circle> circle_through(const CircleData& data) {
  if (data.points.size() < 15) return std::nullopt;
  Circle circle;
  std::vector<double> weights(data.points.size(), 1);
  for (int round = 0; round < 8; ++round) {
    Eigen::Matrix2d system = Eigen::Matrix2d::Zero();
    Vector2d right = Vector2d::Zero();
    for (size_t i = 0; i < data.points.size(); ++i) {
      const Vector2d aside(-data.normals[i].y(), data.normals[i].x());
      system += weights[i] * aside * aside.transpose();
      right += weights[i] * aside.dot(data.points[i]) * aside;
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> values(system);
    if (values.eigenvalues()[0] < 0.01 * values.eigenvalues()[1]) return std::nullopt;
    circle.centre = system.ldlt().solve(right);
    std::vector<double> distances;
    for (const Vector2d& point : data.points) distances.push_back((point - circle.centre).norm());
    circle.radius = median(distances);
    for (size_t i = 0; i < data.points.size(); ++i) {
      const Vector2d from = data.points[i] - circle.centre;
      weights[i] = 0;
      if (distances[i] < 1e-6) continue;
      const double past = data.normals[i].x() * from.y() - data.normals[i].y() * from.x();
      weights[i] = robust_weight(std::pow((distances[i] - circle.radius) / (3 * data.sigma_m), 2) / kWorst +
                                 std::pow(past / (data.sigma_angle * distances[i]), 2) / kWorst);
    }
  }
  return circle;
}

Isometry3d pose_of(const Vector3d& centre, const Vector3d& x, const Vector3d& z) {
  Isometry3d pose = Isometry3d::Identity();
  pose.linear().col(0) = x;
  pose.linear().col(1) = z.cross(x);
  pose.linear().col(2) = z;
  pose.translation() = centre;
  return pose;
}

/// Where what is seen ends; `faces` holds points of a face at either end, by which that end is known better.
std::pair<double, double> ends_of(std::vector<double> values, const std::vector<double>& low_face,
                                  const std::vector<double>& high_face) {
  const double least = kMinFace * static_cast<double>(values.size());
  auto [low, high] = quantiles(values, kTail, 1 - kTail);
  if (static_cast<double>(low_face.size()) >= least) low = std::min(median(low_face), high);
  if (static_cast<double>(high_face.size()) >= least) high = std::max(median(high_face), low);
  return {low, high};
}

/// A box whose edges have this yaw.
PrimitiveShape box_at(const Samples& samples, double yaw) {
  constexpr double kFacing = 0.85;
  PrimitiveShape shape;
  shape.kind = Kind::box;
  const std::array<Vector3d, 3> axes = {Vector3d(std::cos(yaw), std::sin(yaw), 0),
                                        Vector3d(-std::sin(yaw), std::cos(yaw), 0), Vector3d::UnitZ()};
  Vector3d centre = Vector3d::Zero();
  for (size_t axis = 0; axis < axes.size(); ++axis) {
    std::vector<double> values, low_face, high_face;
    for (size_t i = 0; i < samples.points.size(); ++i) {
      values.push_back(axes[axis].dot(samples.points[i]));
      const double facing = axes[axis].dot(samples.normals[i]);
      if (facing > kFacing) high_face.push_back(values.back());
      if (facing < -kFacing) low_face.push_back(values.back());
    }
    auto [low, high] = ends_of(std::move(values), low_face, high_face);
    if (axis == 2) low = samples.base;
    shape.size[static_cast<int>(axis)] = std::max(high - low, 0.001);
    centre += axes[axis] * (low + high) / 2;
  }
  shape.frame_from_shape = pose_of(centre, axes[0], axes[2]);
  return shape;
}

/// A round object about an axis through `foot`, whose radius at distance h along it is as `circle` says.
PrimitiveShape round_at(const Samples& samples, const Vector3d& foot, const Vector3d& x, const Vector3d& axis,
                        const Circle& circle) {
  PrimitiveShape shape;
  shape.kind = circle.slope == 0 ? Kind::cylinder : Kind::cone;
  const bool standing = axis.z() > 0.5;
  std::vector<double> along, low_face, high_face;
  const double reach = 4 * samples.sigma_m;
  for (size_t i = 0; i < samples.points.size(); ++i) {
    const Vector3d from = samples.points[i] - foot;
    const double h = axis.dot(from), distance = (from - h * axis).norm();
    const double radius = circle.radius + circle.slope * h;
    const double facing = axis.dot(samples.normals[i]);
    const bool on_wall = std::abs(distance - radius)<reach, on_end = std::abs(facing)> 0.85;
    if (!(on_wall || (on_end && distance < radius))) continue;
    along.push_back(h);
    if (on_end && distance < radius) (facing > 0 ? high_face : low_face).push_back(h);
  }
  if (along.size() < 10) return shape;
  // What faces along the axis is an end only where nothing is beyond: not the floor of a vessel.
  std::vector<double> copy = along;
  const std::pair<double, double> ends = quantiles(copy, kTail, 1 - kTail);
  std::erase_if(high_face, [&](double h) { return h < ends.second - 3 * reach; });
  std::erase_if(low_face, [&](double h) { return h > ends.first + 3 * reach; });
  auto [low, high] = ends_of(std::move(along), low_face, high_face);
  if (standing) low = samples.base - foot.z();
  const double height = std::max(high - low, 0.001);
  shape.radius_low = std::max(0.0, circle.radius + circle.slope * low);
  shape.radius_high = std::max(0.0, circle.radius + circle.slope * high);
  const double widest = 2 * std::max(shape.radius_low, shape.radius_high);
  shape.size = {widest, widest, height};
  shape.frame_from_shape = pose_of(foot + axis * (low + high) / 2, x, axis);
  return shape;
}

double cost_of(const PrimitiveShape& shape, const Samples& samples) {
  double sum = 0;
  visit_samples(shape, samples, [&](double own, const Misfit&) { sum += own; });
  double result = sum / static_cast<double>(samples.points.size());
  // Nothing reaches below the ground.
  const double lowest =
      shape.frame_from_shape.translation().z() - (shape.kind == Kind::sphere ? shape.radius_low : 0.0);
  if (shape.kind == Kind::sphere && samples.grounded)
    result += std::min(kWorst, std::pow(std::max(0.0, -lowest) / 0.01, 2)) / 3;
  return result;
}

/// Fills in `explained` and `error`.
void judge(PrimitiveShape& shape, const Samples& samples) {
  double on = 0, squares = 0;
  visit_samples(shape, samples, [&](double own, const Misfit& misfit) {
    if (own >= kWorst || misfit.distance > 3 * samples.sigma_m) return;
    ++on;
    squares += misfit.distance * misfit.distance;
  });
  shape.explained = on / static_cast<double>(samples.points.size());
  shape.error = on > 0 ? std::sqrt(squares / on) : 0;
}

std::vector<PrimitiveShape> fit_boxes(const Samples& samples) {
  constexpr int kSteps = 90;
  const auto by_normals = [&](double yaw) {
    double sum = 0;
    for (const Vector3d& normal : samples.normals) {
      if (std::abs(normal.z()) > 0.5) continue;
      const double off = std::remainder(std::atan2(normal.y(), normal.x()) - yaw, kPi / 2);
      sum += std::min(kWorst, std::pow(off / samples.sigma_angle, 2));
    }
    return sum;
  };
  const auto by_area = [&](double yaw) {
    std::vector<double> x, y;
    for (const Vector3d& p : samples.points) {
      x.push_back(std::cos(yaw) * p.x() + std::sin(yaw) * p.y());
      y.push_back(-std::sin(yaw) * p.x() + std::cos(yaw) * p.y());
    }
    const auto [left, right] = quantiles(x, kTail, 1 - kTail);
    const auto [front, back] = quantiles(y, kTail, 1 - kTail);
    return (right - left) * (back - front);
  };
  const auto least = [&](const auto& measure) {
    double best = 0, value = std::numeric_limits<double>::infinity();
    for (int step = 0; step < kSteps; ++step) {
      const double yaw = kPi / 2 * step / kSteps, own = measure(yaw);
      if (own < value) {
        value = own;
        best = yaw;
      }
    }
    return best;
  };
  return {box_at(samples, least(by_normals)), box_at(samples, least(by_area))};
}

std::vector<PrimitiveShape> fit_standing(const Samples& samples) {
  CircleData data{{}, {}, {}, samples.sigma_m, samples.sigma_angle};
  double middle = 0;
  for (size_t i = 0; i < samples.points.size(); ++i) {
    const Vector3d& normal = samples.normals[i];
    if (std::abs(normal.z()) > 0.7) continue;
    data.points.emplace_back(samples.points[i].head<2>());
    data.normals.emplace_back(normal.head<2>().normalized());
    data.heights.push_back(samples.points[i].z());
    middle += samples.points[i].z();
  }
  const std::optional<Circle> first = circle_through(data);
  if (!first) return {};
  middle /= static_cast<double>(data.points.size());
  for (double& height : data.heights) height -= middle;
  std::vector<PrimitiveShape> shapes;
  for (const bool with_slope : {false, true}) {
    const std::optional<Circle> circle = refine(data, *first, with_slope);
    if (!circle) continue;
    if (with_slope && std::abs(circle->slope) < kMinSlope) continue;
    const PrimitiveShape shape = round_at(samples, {circle->centre.x(), circle->centre.y(), middle},
                                          Vector3d::UnitX(), Vector3d::UnitZ(), *circle);
    if (shape.size.z() > 0) shapes.push_back(shape);
  }
  return shapes;
}

std::vector<PrimitiveShape> fit_lying(const Samples& samples) {
  constexpr int kSteps = 36;
  constexpr size_t kTried = 4;
  const auto axis_at = [](double yaw) { return Vector3d(std::cos(yaw), std::sin(yaw), 0); };
  // Normals are across the axis, or along it at the ends.
  std::vector<std::pair<double, double>> yaws;
  for (int step = 0; step < kSteps; ++step) {
    const double yaw = kPi * step / kSteps;
    double sum = 0;
    for (const Vector3d& normal : samples.normals) {
      const double angle = std::acos(std::min(1.0, std::abs(normal.dot(axis_at(yaw)))));
      sum += std::min(kWorst, std::pow(std::min(angle, kPi / 2 - angle) / samples.sigma_angle, 2));
    }
    yaws.emplace_back(sum, yaw);
  }
  std::sort(yaws.begin(), yaws.end());
  yaws.resize(kTried);
  const auto fitted = [&](double yaw) -> std::optional<PrimitiveShape> {
    const Vector3d axis = axis_at(yaw), side(-axis.y(), axis.x(), 0);
    CircleData data{{}, {}, {}, samples.sigma_m, samples.sigma_angle};
    for (size_t i = 0; i < samples.points.size(); ++i) {
      const Vector3d& normal = samples.normals[i];
      if (std::abs(normal.dot(axis)) > 0.5) continue;
      data.points.emplace_back(side.dot(samples.points[i]), samples.points[i].z());
      data.normals.emplace_back(Vector2d(side.dot(normal), normal.z()).normalized());
      data.heights.push_back(0);
    }
    std::optional<Circle> circle = circle_through(data);
    if (circle) circle = refine(data, *circle, false);
    if (circle && samples.grounded && std::abs(circle->centre.y() - circle->radius) < 0.03) {
      data.on_ground = true;
      circle = refine(data, *circle, false);
    }
    if (!circle) return std::nullopt;
    const PrimitiveShape shape =
        round_at(samples, side * circle->centre.x() + Vector3d::UnitZ() * circle->centre.y(),
                 Vector3d::UnitZ(), axis, *circle);
    return shape.size.z() > 0 ? std::optional(shape) : std::nullopt;
  };
  std::optional<PrimitiveShape> best;
  double least = std::numeric_limits<double>::infinity(), chosen = 0;
  const auto consider = [&](double yaw) {
    const std::optional<PrimitiveShape> shape = fitted(yaw);
    const double own = shape ? cost_of(*shape, samples) : least;
    if (own >= least) return;
    least = own;
    best = shape;
    chosen = yaw;
  };
  for (const auto& [sum, yaw] : yaws) consider(yaw);
  if (!best) return {};
  for (double step = 2.5 * kPi / 180; step > 0.4 * kPi / 180; step /= 2)
    for (const double side : {-1.0, 1.0}) consider(chosen + side * step);
  return {*best};
}

std::vector<PrimitiveShape> fit_spheres(const Samples& samples) {
  // As of a circle: lines along the normals meet, then distances are made equal.
  constexpr int kRounds = 20;
  Vector3d centre = Vector3d::Zero();
  double radius = 0;
  std::vector<double> weights(samples.points.size(), 1);
  for (int round = 0; round < kRounds; ++round) {
    Eigen::Matrix4d system = Eigen::Matrix4d::Zero();
    Eigen::Vector4d right = Eigen::Vector4d::Zero();
    double all = 0;
    for (size_t i = 0; i < samples.points.size(); ++i) {
      const Vector3d from = centre - samples.points[i];
      const double distance = std::max(from.norm(), 1e-6);
      const Eigen::Matrix3d across =
          Eigen::Matrix3d::Identity() - samples.normals[i] * samples.normals[i].transpose();
      const double past_sigma = round == 0 ? 1 : samples.sigma_angle * distance;
      const double weight = weights[i] / (past_sigma * past_sigma);
      system.topLeftCorner<3, 3>() += weight * across;
      right.head<3>() -= weight * across * from;
      all += weights[i];
      if (round < 3) continue;
      Eigen::Vector4d row;
      row << from / distance, -1;
      const double own = weights[i] / (samples.sigma_m * samples.sigma_m);
      system += own * row * row.transpose();
      right -= own * (distance - radius) * row;
    }
    if (round < 3) system(3, 3) = 1;
    if (round > 8 && samples.grounded && std::abs(centre.z() - radius) < 0.03) {
      const Eigen::Vector4d row(0, 0, 1, -1);
      const double own = 0.2 * all / (samples.sigma_m * samples.sigma_m);
      system += own * row * row.transpose();
      right -= own * (centre.z() - radius) * row;
    }
    const Eigen::Vector4d step = system.ldlt().solve(right);
    if (!step.allFinite()) return {};
    centre += step.head<3>();
    std::vector<double> distances;
    for (const Vector3d& point : samples.points) distances.push_back((point - centre).norm());
    radius = round < 3 ? median(distances) : radius + step[3];
    const double wide = round < 5 ? 3 : 1;
    for (size_t i = 0; i < samples.points.size(); ++i) {
      const double cosine = samples.normals[i].dot(samples.points[i] - centre) / distances[i];
      const double off = (distances[i] - radius) / samples.sigma_m,
                   turned = std::acos(std::clamp(cosine, -1.0, 1.0)) / samples.sigma_angle;
      weights[i] = robust_weight((off * off + turned * turned) / (wide * wide * kWorst));
    }
  }
  if (!(radius >= 0.005 && radius <= 0.5)) return {};
  PrimitiveShape shape;
  shape.kind = Kind::sphere;
  shape.radius_low = shape.radius_high = radius;
  shape.size = Vector3d::Constant(2 * radius);
  shape.frame_from_shape.translation() = centre;
  return {shape};
}

using Kind = PrimitiveShape::Kind;

constexpr size_t kMinSamples = 30;
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
Samples samples_of(const SurfacePoints& surface, const Eigen::Matrix3d& upright, const Vector3d& origin,
                   const PrimitiveOptions& options) {
  Samples samples;
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
  if (samples.points.size() < kMinSamples) return {};
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
  table.number("noise_m", noise_m, "m", "Standard deviation of the distance of points from a surface.",
               0.0001, 0.1);
  table.number("noise_per_m2", noise_per_m2, "1/m",
               "Increase of that deviation with the square of the distance.", 0, 0.1);
  table.number("normal_deg", normal_deg, "deg", "Standard deviation of the normals.", 1, 90);
  table.number("ground_m", ground_m, "m",
               "Shapes that end closer than this above their support are extended down to it.", 0, 1);
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
  if (count < static_cast<double>(kMinSamples)) return std::nullopt;
  middle /= count;
  const Vector3d up = ground.up.normalized();
  const Vector3d origin = middle - (up.dot(middle) - ground.height / ground.up.norm()) * up;
  const Eigen::Matrix3d upright = rotation_between(up, Vector3d::UnitZ());
  const Samples samples = samples_of(surface, upright, origin, options);
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
