#include "mapping/registration/icp.h"
#include "mapping/registration/parameters.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace loci::mapping::registration {
namespace {

struct Normal {
  Matrix6d hessian = Matrix6d::Zero();
  Vector6d gradient = Vector6d::Zero();
  double squares = 0;
  double weight = 0;
  double possible = 0;

  /// One residual along `direction` of the point's motion.
  void add(const Vector3d& point, const Vector3d& direction, double residual, double weight_of) {
    Vector6d row;
    row << direction, point.cross(direction);
    const Vector6d weighted = weight_of * row;
    hessian.noalias() += weighted * row.transpose();
    gradient += residual * weighted;
    squares += weight_of * residual * residual;
  }
};

Eigen::Matrix3d covariance_of(const Eigen::Vector3f& normal) {
  const Vector3d n = normal.cast<double>();  // Zero where there is no plane: isotropic.
  return Eigen::Matrix3d::Identity() - (1 - kPairs.thickness) * n * n.transpose();
}

/// The three directions along which the residuals of a correspondence are measured, scaled.
Eigen::Matrix3d whitening(Metric metric, const Eigen::Vector3f& target, const Eigen::Vector3f& source) {
  if (metric == Metric::kPoint) return Eigen::Matrix3d::Identity();
  const Eigen::Matrix3d sum = covariance_of(target) + covariance_of(source);
  return Eigen::LLT<Eigen::Matrix3d>((2 * kPairs.thickness) * sum.inverse()).matrixU();
}

class Aligner {
 public:
  Aligner(const Surfels& target, const Surfels& source, const IcpOptions& options)
      : target_(target), source_(source), options_(options) {
    const size_t count = source.size();
    step_ = options.samples > 0 ? std::max<size_t>(1, count / options.samples) : 1;
  }

  Normal linearise(const Isometry3d& pose) const {
    Normal sum;
    const Eigen::Matrix3f turn = pose.linear().cast<float>();
    const Eigen::Vector3f shift = pose.translation().cast<float>();
    const auto radius = static_cast<float>(options_.radius);
    const bool planes = options_.metric == Metric::kPlane;
    for (size_t i = 0; i < source_.size(); i += step_) {
      const float weight = source_.weight[i];
      if (planes && weight <= 0.F) continue;
      sum.possible += planes ? weight : 1;
      const Eigen::Vector3f point = turn * source_.position[i] + shift;
      const Eigen::Vector3f facing = turn * source_.normal[i];
      const uint32_t j = target_.nearest(point, facing, radius);
      if (j == CellGrid::kNone) continue;
      if (planes)
        add_plane(sum, point, facing, weight, j);
      else
        add_points(sum, point, facing, j);
    }
    return sum;
  }

 private:
  double robust(double squared) const {
    const double root = 1 / (1 + squared / (options_.sigma * options_.sigma));
    return root * root;
  }

  /// Weight by the angle between normals: surfels of rounded edges and bars that are not parallel are
  /// different spots and would bias scans from opposite sides.
  static double parallel_weight(double cosine) { return std::clamp((cosine - 0.85) / 0.1, 0.0, 1.0); }

  /// Distance to the plane between the two with the mean normal (Rusinkiewicz 2019), which is symmetric.
  void add_plane(Normal& sum, const Eigen::Vector3f& point, const Eigen::Vector3f& facing,
                 float source_weight, uint32_t j) const {
    const double same = parallel_weight(static_cast<double>(target_.normal[j].dot(facing)));
    const double both = same * static_cast<double>(std::min(source_weight, target_.weight[j]));
    if (both <= 0) return;
    const Vector3d normal = (target_.normal[j] + facing).cast<double>().normalized();
    const Vector3d at = point.cast<double>();
    const double residual = normal.dot(at - target_.position[j].cast<double>());
    const double weight = both * robust(residual * residual);
    sum.add(at, normal, residual, weight);
    sum.weight += weight;
  }

  void add_points(Normal& sum, const Eigen::Vector3f& point, const Eigen::Vector3f& facing,
                  uint32_t j) const {
    const Vector3d at = point.cast<double>();
    const Vector3d offset = at - target_.position[j].cast<double>();
    const Eigen::Matrix3d directions = whitening(options_.metric, target_.normal[j], facing);
    const double weight = robust((directions * offset).squaredNorm());
    for (int k = 0; k < 3; ++k) {
      const Vector3d direction = directions.row(k);
      sum.add(at, direction, direction.dot(offset), weight);
    }
    sum.weight += weight;
  }

  const Surfels& target_;
  const Surfels& source_;
  const IcpOptions& options_;
  size_t step_ = 1;
};

/// The Gauss-Newton step in the free directions; the damping keeps unconstrained directions in place.
Vector6d step_of(const Normal& sum, bool planar) {
  const Matrix6d& hessian = sum.hessian;
  const double damping = 1e-6 * hessian.diagonal().maxCoeff() + 1e-12;
  if (planar) {
    const std::array<int, 3> free = {0, 1, 5};
    const Eigen::Matrix3d part = hessian(free, free) + damping * Eigen::Matrix3d::Identity();
    const Vector3d solved = part.ldlt().solve(Vector3d(-sum.gradient(free)));
    Vector6d step = Vector6d::Zero();
    step(free) = solved;
    return step;
  }
  return (hessian + damping * Matrix6d::Identity()).ldlt().solve(-sum.gradient);
}

Isometry3d moved(const Vector6d& step, const Isometry3d& pose) {
  Isometry3d result = Isometry3d::Identity();
  const double angle = step.tail<3>().norm();
  if (angle > 0) result.linear() = Eigen::AngleAxisd(angle, step.tail<3>() / angle).toRotationMatrix();
  result.translation() = step.head<3>();
  result = result * pose;
  result.linear() = Eigen::Quaterniond(result.linear()).normalized().toRotationMatrix();
  return result;
}

}  // namespace

IcpResult icp(const Surfels& target, const Surfels& source, const Isometry3d& target_from_source,
              const IcpOptions& options) {
  const Aligner aligner(target, source, options);
  IcpResult result;
  result.target_from_source = target_from_source;
  Normal sum = aligner.linearise(result.target_from_source);
  while (result.iterations < options.iterations && sum.weight > 0) {
    ++result.iterations;
    const Vector6d step = step_of(sum, options.planar);
    result.target_from_source = moved(step, result.target_from_source);
    sum = aligner.linearise(result.target_from_source);
    // The rotation is about the target's origin; the criterion is the motion of the source's origin.
    const Vector3d shift = step.head<3>() + step.tail<3>().cross(result.target_from_source.translation());
    if (shift.norm() < options.accuracy && step.tail<3>().norm() < options.accuracy) break;
  }
  result.hessian = sum.hessian;
  result.weight = sum.weight;
  result.rmse = sum.weight > 0 ? std::sqrt(sum.squares / sum.weight) : 0;
  result.score = sum.possible > 0 ? sum.weight / sum.possible : 0;
  return result;
}

}  // namespace loci::mapping::registration
