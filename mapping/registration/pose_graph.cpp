#include "mapping/registration/pose_graph.h"

#include <ceres/ceres.h>
#include <ceres/rotation.h>

#include <Eigen/Cholesky>
#include <array>

namespace loci::mapping::registration {
namespace {

using Matrix6d = Eigen::Matrix<double, 6, 6>;
/// A change of a pose: shift and rotation vector, both along the map's axes, about the node's own position.
using Change = std::array<double, 6>;

template <class T>
using Matrix3 = Eigen::Matrix<T, 3, 3>;
template <class T>
using Vector3 = Eigen::Matrix<T, 3, 1>;

struct EdgeResidual {
  Isometry3d target, source;  ///< poses before the change
  Edge edge;
  Matrix6d root;  ///< of the information

  template <class T>
  static void changed(const Isometry3d& pose, const T* change, Matrix3<T>& rotation, Vector3<T>& position) {
    Matrix3<T> turn;
    ceres::AngleAxisToRotationMatrix(change + 3, turn.data());  // Column-major, as Eigen's.
    rotation = turn * pose.linear().cast<T>();
    position = pose.translation().cast<T>() + Vector3<T>(change[0], change[1], change[2]);
  }

  template <class T>
  bool operator()(const T* target_change, const T* source_change, T* residual) const {
    Matrix3<T> target_rotation, source_rotation;
    Vector3<T> target_position, source_position;
    changed(target, target_change, target_rotation, target_position);
    changed(source, source_change, source_rotation, source_position);
    const Matrix3<T> rotation = target_rotation.transpose() * source_rotation;
    const Vector3<T> position = target_rotation.transpose() * (source_position - target_position);
    // The motion in the target's frame that takes the measured pose to the present one.
    const Matrix3<T> off = rotation * edge.target_from_source.linear().transpose().cast<T>();
    Eigen::Matrix<T, 6, 1> error;
    error.template head<3>() = position - off * edge.target_from_source.translation().cast<T>();
    Vector3<T> turn;
    ceres::RotationMatrixToAngleAxis(off.data(), turn.data());
    error.template tail<3>() = turn;
    Eigen::Map<Eigen::Matrix<T, 6, 1>>{residual} = root.cast<T>() * error;
    return true;
  }
};

Matrix6d root_of(const Matrix6d& information) {
  const double smallest = 1e-9 * information.diagonal().maxCoeff() + 1e-12;
  return Eigen::LLT<Matrix6d>(information + smallest * Matrix6d::Identity()).matrixU();
}

}  // namespace

std::vector<double> solve_pose_graph(std::vector<Isometry3d>& map_from_node, const std::vector<bool>& fixed,
                                     const std::vector<Edge>& edges, bool planar) {
  std::vector<Change> changes(map_from_node.size(), Change{});
  std::vector<EdgeResidual> residuals;
  residuals.reserve(edges.size());
  ceres::Problem problem;
  for (const Edge& edge : edges) {
    residuals.push_back(
        {map_from_node[edge.target], map_from_node[edge.source], edge, root_of(edge.information)});
    using Cost = ceres::AutoDiffCostFunction<EdgeResidual, 6, 6, 6>;
    problem.AddResidualBlock(new Cost(new EdgeResidual(residuals.back())), new ceres::CauchyLoss(3.0),
                             changes[edge.target].data(), changes[edge.source].data());
  }
  for (size_t i = 0; i < changes.size(); ++i) {
    if (!problem.HasParameterBlock(changes[i].data())) continue;
    if (fixed[i])
      problem.SetParameterBlockConstant(changes[i].data());
    else if (planar)
      problem.SetManifold(changes[i].data(), new ceres::SubsetManifold(6, {2, 3, 4}));
  }
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  options.num_threads = 1;  // Same bytes on any number.
  options.max_num_iterations = 100;
  options.function_tolerance = 1e-10;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  if (!edges.empty()) ceres::Solve(options, &problem, &summary);

  std::vector<double> off;
  for (const EdgeResidual& residual : residuals) {
    Eigen::Matrix<double, 6, 1> error;
    residual(changes[residual.edge.target].data(), changes[residual.edge.source].data(), error.data());
    off.push_back(error.norm());
  }
  for (size_t i = 0; i < changes.size(); ++i) {
    Eigen::Matrix3d rotation;
    Vector3d position;
    EdgeResidual::changed(map_from_node[i], changes[i].data(), rotation, position);
    map_from_node[i].linear() = Eigen::Quaterniond(rotation).normalized().toRotationMatrix();
    map_from_node[i].translation() = position;
  }
  return off;
}

}  // namespace loci::mapping::registration
