#include "mapping/tracking/pose_graph.h"

#include <ceres/ceres.h>

#include <Eigen/Cholesky>

#include <algorithm>

namespace loci::mapping::tracking {
namespace {

struct PoseBlock {
  double translation[3];
  double rotation[4];  ///< x, y, z, w
};

/// (translation, rotation vector) of the pose measured from the pose estimated, weighted.
struct RelativePose {
  Eigen::Quaterniond rotation;
  Vector3d translation;
  Matrix6d weight;  ///< W with Wᵀ W = information

  template <class T>
  bool operator()(const T* from_t, const T* from_q, const T* to_t, const T* to_q, T* residual) const {
    using Vector3 = Eigen::Matrix<T, 3, 1>;
    const Eigen::Map<const Eigen::Quaternion<T>> qf(from_q), qt(to_q);
    const Eigen::Map<const Vector3> tf(from_t), tt(to_t);
    const Eigen::Quaternion<T> measured = rotation.cast<T>();
    const Vector3 seen = qf.conjugate() * Vector3(tt - tf);
    const Eigen::Quaternion<T> turn = measured.conjugate() * (qf.conjugate() * qt);
    Eigen::Matrix<T, 6, 1> error;
    error.template head<3>() = measured.conjugate() * Vector3(seen - translation.cast<T>());
    error.template tail<3>() = (turn.w() < T(0) ? T(-2) : T(2)) * turn.vec();
    Eigen::Map<Eigen::Matrix<T, 6, 1>>(residual, 6) = weight.cast<T>() * error;
    return true;
  }
};

struct Upright {
  Vector3d up;
  double weight;

  template <class T>
  bool operator()(const T* q, T* residual) const {
    const Eigen::Matrix<T, 3, 1> z = Eigen::Map<const Eigen::Quaternion<T>>(q) * up.cast<T>();
    residual[0] = T(weight) * z.x();
    residual[1] = T(weight) * z.y();
    residual[2] = T(weight) * (z.z() - T(1));
    return true;
  }
};

PoseBlock block_of(const Isometry3d& pose) {
  const Eigen::Quaterniond q(pose.linear());
  return {{pose.translation().x(), pose.translation().y(), pose.translation().z()},
          {q.x(), q.y(), q.z(), q.w()}};
}

Isometry3d pose_of(const PoseBlock& block) {
  Isometry3d pose = Isometry3d::Identity();
  pose.linear() = Eigen::Map<const Eigen::Quaterniond>(block.rotation).normalized().toRotationMatrix();
  pose.translation() = Eigen::Map<const Vector3d>(block.translation);
  return pose;
}

}  // namespace

double optimise(std::vector<Isometry3d>& map_from_frames, const std::vector<PoseConstraint>& constraints,
                const std::vector<UpConstraint>& ups) {
  if (map_from_frames.empty()) return 0;
  std::vector<PoseBlock> blocks;
  for (const Isometry3d& pose : map_from_frames) blocks.push_back(block_of(pose));
  PoseBlock map = block_of(Isometry3d::Identity());
  ceres::Problem problem;
  const auto add = [&](PoseBlock& block) {
    problem.AddParameterBlock(block.translation, 3);
    problem.AddParameterBlock(block.rotation, 4, new ceres::EigenQuaternionManifold);
  };
  const auto fix = [&](PoseBlock& block) {
    problem.SetParameterBlockConstant(block.translation);
    problem.SetParameterBlockConstant(block.rotation);
  };
  for (PoseBlock& block : blocks) add(block);
  add(map);
  fix(map);
  bool anchored = false;
  for (const PoseConstraint& constraint : constraints) {
    anchored = anchored || constraint.from == PoseConstraint::kMap;
    PoseBlock& from = constraint.from == PoseConstraint::kMap ? map : blocks.at(constraint.from);
    PoseBlock& to = blocks.at(constraint.to);
    const Eigen::LLT<Matrix6d> root(constraint.information);
    auto* cost = new RelativePose{Eigen::Quaterniond(constraint.from_from_to.linear()),
                                  constraint.from_from_to.translation(), root.matrixU()};
    problem.AddResidualBlock(new ceres::AutoDiffCostFunction<RelativePose, 6, 3, 4, 3, 4>(cost),
                             new ceres::CauchyLoss(3), from.translation, from.rotation, to.translation,
                             to.rotation);
  }
  for (const UpConstraint& up : ups)
    problem.AddResidualBlock(
        new ceres::AutoDiffCostFunction<Upright, 3, 4>(new Upright{up.up, 1 / up.sigma_rad}),
        new ceres::CauchyLoss(3), blocks.at(up.pose).rotation);
  if (!anchored) {
    problem.SetParameterBlockConstant(blocks.front().translation);
    if (ups.empty()) problem.SetParameterBlockConstant(blocks.front().rotation);
  }
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  options.max_num_iterations = 30;
  options.num_threads = 1;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  if (!summary.IsSolutionUsable()) return 0;
  double moved = 0;
  for (size_t i = 0; i < blocks.size(); ++i) {
    const Isometry3d pose = pose_of(blocks[i]);
    moved = std::max(moved, (pose.translation() - map_from_frames[i].translation()).norm());
    map_from_frames[i] = pose;
  }
  return moved;
}

}  // namespace loci::mapping::tracking
