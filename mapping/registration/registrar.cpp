#include "mapping/registration/registrar.h"

#include <ceres/ceres.h>
#include <ceres/rotation.h>
#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>

#include "mapping/base/error.h"
#include "mapping/base/math/pose.h"
#include "mapping/base/parallel.h"
#include "mapping/registration/icp.h"
#include "mapping/registration/parameters.h"

namespace loci::mapping::registration {
namespace {

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
  if (!edges.empty()) {
    ceres::Solve(options, &problem, &summary);
    if (!summary.IsSolutionUsable())
      throw Error("the pose graph could not be solved: " + summary.message, {"", 0, "registration"},
                  "check the poses and covariances of the scans");
  }

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

namespace {

/// Odometry between consecutive scans; deviations are about the source's own origin.
Edge odometry_edge(size_t target, const Isometry3d& target_from_source, const SearchWindow& expected) {
  const double position = std::max(expected.position, kGraph.best_odometry.position);
  const double angle = std::max(expected.angle, kGraph.best_odometry.angle);
  Matrix6d information = Matrix6d::Zero();
  information.diagonal() << Vector3d::Constant(1 / (position * position)),
      Vector3d::Constant(1 / (angle * angle));
  // A rotation about the target's origin also moves the source.
  const Vector3d t = target_from_source.translation();
  Matrix6d own = Matrix6d::Identity();
  own.topRightCorner<3, 3>() << 0, t.z(), -t.y(), -t.z(), 0, t.x(), t.y(), -t.x(), 0;
  return {target, target + 1, target_from_source, own.transpose() * information * own};
}

}  // namespace

Registrar::Registrar(const RegistrationOptions& options) : options_(options) {}

void Registrar::add(PreparedScan scan, const Isometry3d& map_from_scan, const SearchWindow& window,
                    const SearchWindow& expected) {
  const size_t added = scans_.size();
  if (added > 0)
    odometry_.push_back(
        odometry_edge(added - 1, result_.map_from_scan[added - 1].inverse() * map_from_scan, expected));
  result_.names.push_back(scan.name);
  result_.map_from_scan.push_back(map_from_scan);
  scans_.push_back(std::move(scan));
  root_.push_back(added);
  const std::vector<Candidate> candidates = candidates_of(added, added, window.position);
  if (connect(added, candidates, window)) refine(added, candidates, window);
  update_parts();
}

void Registrar::retry(const SearchWindow& window) {
  for (size_t scan = 0; scan < scans_.size(); ++scan) {
    const size_t main = main_part();
    if (root_[scan] == main) continue;
    std::vector<Candidate> candidates = candidates_of(scan, scans_.size(), window.position);
    std::erase_if(candidates, [&](const Candidate& candidate) { return root_[candidate.scan] != main; });
    if (connect(scan, candidates, window)) refine(scan, candidates, window);
    update_parts();
  }
}

/// First scan of the part with most scans, of the earlier one if there are several: what the others are
/// measured by, as the first scan may look at a corner that none of the others sees.
size_t Registrar::main_part() const {
  std::vector<size_t> sizes(scans_.size(), 0);
  for (const size_t root : root_) ++sizes[root];
  return static_cast<size_t>(std::max_element(sizes.begin(), sizes.end()) - sizes.begin());
}

/// Scans before `end` that may share enough surface, largest overlap first.
std::vector<Registrar::Candidate> Registrar::candidates_of(size_t scan, size_t end, double reach) const {
  std::vector<Candidate> candidates;
  const Isometry3d& pose = result_.map_from_scan[scan];
  for (size_t other = 0; other < end; ++other) {
    if (other == scan) continue;
    const Isometry3d other_from_scan = result_.map_from_scan[other].inverse() * pose;
    const double overlap = std::max(expected_overlap(scans_[other], scans_[scan], other_from_scan),
                                    expected_overlap(scans_[scan], scans_[other], other_from_scan.inverse()));
    // Within a wide window the overlap may be larger than at the guess.
    const double min_overlap = kGraph.promising * options_.min_overlap / (1 + reach);
    if (overlap >= min_overlap) candidates.push_back({other, overlap});
  }
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.overlap > b.overlap; });
  return candidates;
}

PairAlignment Registrar::aligned(size_t target, size_t source, const SearchWindow& window) const {
  const Isometry3d guess = result_.map_from_scan[target].inverse() * result_.map_from_scan[source];
  PairAlignment pair = align_pair(scans_[target], scans_[source], guess, window, options_);
  pair.target = target;
  pair.source = source;
  return pair;
}

/// Searches until one pair is trusted, and moves the scan to its pose.
bool Registrar::connect(size_t scan, const std::vector<Candidate>& candidates, const SearchWindow& window) {
  size_t searches = 0;
  for (const Candidate& candidate : candidates) {
    if (++searches > kGraph.max_searches) break;
    PairAlignment pair = aligned(candidate.scan, scan, window);
    const bool trusted = pair.trusted;
    if (trusted)
      result_.map_from_scan[scan] = result_.map_from_scan[candidate.scan] * pair.target_from_source;
    record(std::move(pair));
    if (!trusted) continue;
    update_parts();
    return true;
  }
  return false;
}

/// Aligns a connected scan with the others that it overlaps. Scans of other parts of the graph are searched
/// in a wider window, as both parts have errors.
void Registrar::refine(size_t scan, const std::vector<Candidate>& candidates, const SearchWindow& window) {
  std::vector<PairAlignment> pairs(candidates.size());
  const SearchWindow between = {kGraph.between_parts * window.position, kGraph.between_parts * window.angle};
  parallel_for(candidates.size(), options_.threads, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const size_t other = candidates[i].scan;
      pairs[i] = aligned(other, scan, root_[other] == root_[scan] ? kGraph.refine : between);
    }
  });
  for (PairAlignment& pair : pairs) record(std::move(pair));
}

/// Keeps one verdict per pair: a trusted one, otherwise the latest.
void Registrar::record(PairAlignment pair) {
  for (PairAlignment& known : result_.pairs) {
    const bool same = known.target == pair.target && known.source == pair.source;
    const bool turned = known.target == pair.source && known.source == pair.target;
    if (!same && !turned) continue;
    if (!known.trusted) known = std::move(pair);
    return;
  }
  result_.pairs.push_back(std::move(pair));
}

/// Follows trusted pairs from each part's first scan. A newly connected part moves as a rigid whole.
void Registrar::update_parts() {
  std::vector<size_t> part = root_;
  std::vector<bool> reached(scans_.size(), false);
  const auto join = [&](size_t at, size_t next, const Isometry3d& at_from_next) {
    const Isometry3d move = result_.map_from_scan[at] * at_from_next * result_.map_from_scan[next].inverse();
    const size_t joining = part[next];
    for (size_t i = 0; i < part.size(); ++i) {
      if (part[i] != joining) continue;
      result_.map_from_scan[i] = move * result_.map_from_scan[i];
      part[i] = part[at];
    }
  };
  for (size_t first = 0; first < scans_.size(); ++first) {
    if (reached[first]) continue;
    std::vector<size_t> open = {first};
    reached[first] = true;
    while (!open.empty()) {
      const size_t at = open.back();
      open.pop_back();
      root_[at] = first;
      for (const PairAlignment& pair : result_.pairs) {
        if (!pair.trusted || (pair.target != at && pair.source != at)) continue;
        const bool forward = pair.target == at;
        const size_t next = forward ? pair.source : pair.target;
        if (reached[next]) continue;
        reached[next] = true;
        open.push_back(next);
        if (part[next] != part[at])
          join(at, next, forward ? pair.target_from_source : pair.target_from_source.inverse());
      }
    }
  }
}

void Registrar::solve() {
  for (int round = 0; round < 3; ++round) {
    update_parts();
    std::vector<Edge> edges;
    std::vector<PairAlignment*> pairs;
    for (PairAlignment& pair : result_.pairs) {
      if (!pair.trusted) continue;
      edges.push_back({pair.target, pair.source, pair.target_from_source, pair.information});
      pairs.push_back(&pair);
    }
    for (const Edge& edge : odometry_)
      if (root_[edge.target] != root_[edge.source]) edges.push_back(edge);
    std::vector<bool> fixed(scans_.size(), false);
    fixed[0] = true;
    const std::vector<double> off = solve_pose_graph(result_.map_from_scan, fixed, edges, options_.dof == 3);
    bool contradiction = false;
    for (size_t i = 0; i < pairs.size(); ++i) {
      if (off[i] < kGraph.contradiction_sigmas) continue;
      pairs[i]->trusted = false;
      pairs[i]->reason = "contradicts the other pairs";
      contradiction = true;
    }
    if (!contradiction) break;
  }
  update_parts();
  result_.connected.resize(scans_.size());
  const size_t main = main_part();
  for (size_t i = 0; i < scans_.size(); ++i) result_.connected[i] = root_[i] == main;
}

}  // namespace loci::mapping::registration
