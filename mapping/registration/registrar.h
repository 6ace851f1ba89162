#pragma once

#include <vector>

#include "mapping/registration/pair.h"
#include "mapping/registration/registration.h"

namespace loci::mapping::registration {

/// A measured relative pose of two nodes.
struct Edge {
  size_t target = 0, source = 0;
  Isometry3d target_from_source = Isometry3d::Identity();
  Eigen::Matrix<double, 6, 6> information;  ///< of a motion in the target's frame
};

/// Robust least squares over relative poses with fixed nodes. Planar: only x, y and yaw (about the map's z)
/// of the nodes change. Returns the final residual of each edge in standard deviations.
std::vector<double> solve_pose_graph(std::vector<Isometry3d>& map_from_node, const std::vector<bool>& fixed,
                                     const std::vector<Edge>& edges, bool planar);

/// Scans, aligned pairs and poses: shared by register_scans and IncrementalRegistration.
class Registrar {
 public:
  explicit Registrar(const RegistrationOptions& options);

  /// Aligns a scan with earlier ones that it may overlap: a search over the window until a pair is trusted,
  /// then refinement of the other pairs. `expected`: standard deviation of the pose relative to the previous
  /// scan.
  void add(PreparedScan scan, const Isometry3d& map_from_scan, const SearchWindow& window,
           const SearchWindow& expected);
  /// Repeats the pairs between the largest part of the graph and the other scans with the improved poses.
  void retry(const SearchWindow& window);
  /// Poses of all scans from all trusted pairs; pairs that contradict the others are not trusted any more.
  /// Parts of the graph without a trusted pair between them are connected by odometry.
  void solve();

  const RegistrationResult& result() const { return result_; }
  RegistrationResult& result() { return result_; }
  size_t size() const { return scans_.size(); }

 private:
  struct Candidate {
    size_t scan = 0;
    double overlap = 0;
  };

  std::vector<Candidate> candidates_of(size_t scan, size_t end, double reach) const;
  PairAlignment aligned(size_t target, size_t source, const SearchWindow& window) const;
  bool connect(size_t scan, const std::vector<Candidate>& candidates, const SearchWindow& window);
  void refine(size_t scan, const std::vector<Candidate>& candidates, const SearchWindow& window);
  void record(PairAlignment pair);
  void update_parts();
  size_t main_part() const;

  RegistrationOptions options_;
  std::vector<PreparedScan> scans_;
  std::vector<size_t> root_;    ///< first scan of each scan's part of the graph
  std::vector<Edge> odometry_;  ///< from each scan to the next
  RegistrationResult result_;
};

}  // namespace loci::mapping::registration
