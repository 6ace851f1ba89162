#pragma once

#include <memory>
#include <string>
#include <vector>

#include "mapping/base/json_fwd.h"
#include "mapping/base/options.h"
#include "mapping/base/progress.h"
#include "mapping/sensor/scan.h"

namespace loci::mapping {

struct RegistrationOptions {
  std::string method = "plane";   ///< point (§7.3), plane, generalised
  int dof = 3;                    ///< 3: x, y, yaw of a levelled robot; 6: all
  double position_error_m = 0.3;  ///< expected localisation error (σ): the search reaches twice as far
  double yaw_error_deg = 15;      ///< expected (σ)
  double voxel_m = 0.05;          ///< of the finest level
  double min_overlap = 0.3;       ///< less shared surface is no evidence
  double max_conflict = 0.02;     ///< more points in free space, and it is another place
  double min_degeneracy = 0.003;  ///< less, and the pose may slide or turn
  double rmse_max_m = 0.03;       ///< more, and it is another surface
  double rival_gap = 0.03;        ///< a second pose must fit worse by this part of the surface
  int threads = 0;  ///< 0 = all cores; not declared as an option: the result is the same on any number

  void declare(OptionTable& table);
};

/// What is known of one pair of scans after aligning it.
struct PairAlignment {
  size_t target = 0, source = 0;  ///< indices into the scan set
  Isometry3d target_from_source = Isometry3d::Identity();
  /// x y z roll pitch yaw of a motion in the target's frame, about its origin.
  Eigen::Matrix<double, 6, 6> information = Eigen::Matrix<double, 6, 6>::Zero();
  double overlap = 0;     ///< part of the smaller scan's visible surface that the other one has, too
  double rmse_m = 0;      ///< over the overlap
  double degeneracy = 0;  ///< smallest over largest eigenvalue of the scaled Hessian
  double conflict = 0;    ///< part of the points that stand in space that the other scan saw to be free
  bool trusted = false;
  std::string reason;  ///< in words, why or why not
};

struct RegistrationResult {
  std::vector<std::string> names;         ///< of the scans
  std::vector<Isometry3d> map_from_scan;  ///< one per scan
  /// Whether a trusted chain of pairs leads to the first scan. Scans without one stand by odometry only:
  /// where they were said to be beside the scan before them (and after them, if that one is connected).
  std::vector<bool> connected;
  std::vector<PairAlignment> pairs;  ///< that were tried
  double seconds = 0;

  /// Whether the poses say more than the input: every scan is alone, or at least one pair is trusted.
  bool usable() const;
  size_t connected_count() const;
  std::string summary() const;
  Json report() const;
};

/// Aligns one pair from an initial guess, coarse to fine: a search over turns and shifts within twice the
/// expected error, then iterative closest point on the surface that both scans have. Never throws for scans
/// that do not fit: the verdict says so.
PairAlignment align(const Scan& target, const Scan& source, const Isometry3d& target_from_source,
                    const RegistrationOptions& options);

/// All overlapping pairs, then a pose graph with robust loss; the first scan stays where it is. Scans without
/// a trusted connection are placed by odometry, beside their neighbours, and named. Error for a set without
/// scans.
RegistrationResult register_scans(const ScanSet& scans, const RegistrationOptions& options,
                                  Progress& progress);

/// Adds scans one by one as a robot takes them: what was aligned before is not aligned again.
class IncrementalRegistration {
 public:
  explicit IncrementalRegistration(const RegistrationOptions& options);
  ~IncrementalRegistration();

  /// Aligns the scan with those before it that it overlaps and solves the graph; poses of all may change.
  /// The scan's pose is where the search begins, and where it stays beside the scan before it as long as no
  /// pair is trusted; its covariance (where not zero) says how far the search reaches.
  const RegistrationResult& add(const Scan& scan);
  const RegistrationResult& result() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace loci::mapping
