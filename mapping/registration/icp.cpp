#include "mapping/registration/icp.h"
#include "mapping/registration/parameters.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

namespace loci::mapping::registration {
namespace {

/// Sums of the normal equations. Rows are a residual's derivatives, the residual, and 1, so that one product
/// holds the Hessian, the gradient, the squares and the weights.
class NormalEquations {
 public:
  /// One residual along `direction` of the point's motion. `one` = 0: the weight counts with another one.
  void add(const Eigen::Vector3f& point, const Eigen::Vector3f& direction, float residual, float weight,
           float one) {
    const Eigen::Vector3f turning = point.cross(direction);
    const std::array<float, 8> row = {direction.x(), direction.y(), direction.z(), turning.x(),
                                      turning.y(),   turning.z(),   residual,      one};
    for (size_t i = 0; i < 8; ++i) {
      const float weighted = weight * row[i];
      for (size_t j = i < 4 ? 0 : 4; j < 8; ++j) part_[8 * i + j] += weighted * row[j];
    }
    if (++added_ == kMaxAdded) flush();
  }
  void flush() {
    for (size_t k = 0; k < part_.size(); ++k) sums_[k] += static_cast<double>(part_[k]);
    part_.fill(0);
    added_ = 0;
  }

  // After the last flush:
  Matrix6d hessian() const {
    Matrix6d matrix;
    for (Eigen::Index i = 0; i < 6; ++i)
      for (Eigen::Index j = i; j < 6; ++j) matrix(i, j) = matrix(j, i) = at(i, j);
    return matrix;
  }
  Vector6d gradient() const {
    Vector6d vector;
    for (Eigen::Index i = 0; i < 6; ++i) vector[i] = at(i, 6);
    return vector;
  }
  double squares() const { return at(6, 6); }
  double weight() const { return at(7, 7); }

 private:
  static constexpr int kMaxAdded = 256;  ///< to a part in single precision
  double at(Eigen::Index i, Eigen::Index j) const { return sums_[static_cast<size_t>(8 * i + j)]; }

  alignas(16) std::array<float, 64> part_ = {};
  std::array<double, 64> sums_ = {};
  int added_ = 0;
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
    const size_t step = options.samples > 0 ? std::max<size_t>(1, count / options.samples) : 1;
    samples_.reserve(count / step + 1);
    for (size_t i = 0; i < count; i += step) {
      const bool plane = options.metric == Metric::kPlane;
      if (plane && source.weight[i] <= 0.F) continue;
      samples_.push_back(static_cast<uint32_t>(i));
      possible_ += plane ? static_cast<double>(source.weight[i]) : 1;
      reach_ = std::max(reach_, static_cast<double>(source.position[i].norm()));
    }
    matches_.assign(samples_.size(), CellGrid::kNone);
  }

  /// Sum of the weights if all were to fit.
  double possible() const { return possible_; }

  NormalEquations linearise(const Isometry3d& pose) {
    NormalEquations sum;
    const Eigen::Matrix3f turn = pose.linear().cast<float>();
    const Eigen::Vector3f shift = pose.translation().cast<float>();
    const auto radius = static_cast<float>(options_.radius);
    const bool searches = !has_matches_at(pose);
    for (size_t k = 0; k < samples_.size(); ++k) {
      if (!searches && matches_[k] == CellGrid::kNone) continue;
      const uint32_t i = samples_[k];
      const Eigen::Vector3f point = turn * source_.position[i] + shift;
      const Eigen::Vector3f facing = turn * source_.normal[i];
      if (searches) matches_[k] = target_.nearest(point, facing, radius);
      const uint32_t j = matches_[k];
      if (j == CellGrid::kNone) continue;
      if (options_.metric == Metric::kPlane)
        add_plane(sum, point, facing, source_.weight[i], j);
      else
        add_points(sum, point, facing, j);
    }
    if (searches) matched_at_ = pose;
    sum.flush();
    return sum;
  }

 private:
  /// Whether no point moved by more than a small part of a cell since matches were searched: then they are
  /// hardly others.
  bool has_matches_at(const Isometry3d& pose) const {
    if (!matched_at_) return false;
    const double shift = (pose.translation() - matched_at_->translation()).norm();
    const double turn = (pose.linear() - matched_at_->linear()).norm();
    return shift + turn * reach_ < kPairs.same_match_cells * target_.cell;
  }

  float robust(float squared) const {
    const float root = 1 / (1 + squared / static_cast<float>(options_.sigma * options_.sigma));
    return root * root;
  }

  /// Weight by the angle between normals: surfels of rounded edges and bars that are not parallel are
  /// different spots and would bias scans from opposite sides.
  static float parallel_weight(float cosine) { return std::clamp((cosine - 0.85F) / 0.1F, 0.F, 1.F); }

  /// Distance to the plane between the two with the mean normal (Rusinkiewicz 2019), which is symmetric.
  void add_plane(NormalEquations& sum, const Eigen::Vector3f& point, const Eigen::Vector3f& facing,
                 float source_weight, uint32_t j) const {
    const float both =
        parallel_weight(target_.normal[j].dot(facing)) * std::min(source_weight, target_.weight[j]);
    if (both <= 0) return;
    const Eigen::Vector3f normal = (target_.normal[j] + facing).normalized();
    const float residual = normal.dot(point - target_.position[j]);
    sum.add(point, normal, residual, both * robust(residual * residual), 1);
  }

  void add_points(NormalEquations& sum, const Eigen::Vector3f& point, const Eigen::Vector3f& facing,
                  uint32_t j) const {
    const Eigen::Vector3f offset = point - target_.position[j];
    const Eigen::Matrix3f directions = whitening(options_.metric, target_.normal[j], facing).cast<float>();
    const float weight = robust((directions * offset).squaredNorm());
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3f direction = directions.row(k);
      sum.add(point, direction, direction.dot(offset), weight, k == 0 ? 1 : 0);
    }
  }

  const Surfels& target_;
  const Surfels& source_;
  const IcpOptions& options_;
  std::vector<uint32_t> samples_;  ///< surfels of the source that take part
  double possible_ = 0;
  double reach_ = 0;  ///< of the samples from the source's origin, metres
  std::vector<uint32_t> matches_;
  std::optional<Isometry3d> matched_at_;
};

/// The Gauss-Newton step in the free directions; the damping keeps unconstrained directions in place.
Vector6d step_of(const NormalEquations& sum, bool planar) {
  const Matrix6d hessian = sum.hessian();
  const Vector6d gradient = sum.gradient();
  const double damping = 1e-6 * hessian.diagonal().maxCoeff() + 1e-12;
  if (planar) {
    const std::array<int, 3> free = {0, 1, 5};
    const Eigen::Matrix3d part = hessian(free, free) + damping * Eigen::Matrix3d::Identity();
    const Vector3d solved = part.ldlt().solve(Vector3d(-gradient(free)));
    Vector6d step = Vector6d::Zero();
    step(free) = solved;
    return step;
  }
  return (hessian + damping * Matrix6d::Identity()).ldlt().solve(-gradient);
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
  Aligner aligner(target, source, options);
  IcpResult result;
  result.target_from_source = target_from_source;
  NormalEquations sum = aligner.linearise(result.target_from_source);
  while (result.iterations < options.iterations && sum.weight() > 0) {
    ++result.iterations;
    const Vector6d step = step_of(sum, options.planar);
    result.target_from_source = moved(step, result.target_from_source);
    sum = aligner.linearise(result.target_from_source);
    // The rotation is about the target's origin; the criterion is the motion of the source's origin.
    const Vector3d shift = step.head<3>() + step.tail<3>().cross(result.target_from_source.translation());
    if (shift.norm() < options.accuracy && step.tail<3>().norm() < options.accuracy) break;
  }
  result.hessian = sum.hessian();
  result.weight = sum.weight();
  result.rmse = sum.weight() > 0 ? std::sqrt(sum.squares() / sum.weight()) : 0;
  result.score = aligner.possible() > 0 ? sum.weight() / aligner.possible() : 0;
  return result;
}

}  // namespace loci::mapping::registration
