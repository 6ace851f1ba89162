#pragma once

#include <string>
#include <vector>

#include "mapping/base/json.h"
#include "mapping/base/options.h"
#include "mapping/base/progress.h"
#include "mapping/sensor/scan.h"

namespace loci {

struct RegistrationOptions {
  std::string method = "plane";   ///< point (§7.3), plane, generalised
  int dof = 3;                    ///< 3: x, y, yaw of a levelled robot; 6: all
  double position_error_m = 0.3;  ///< expected localisation error: the widest search radius
  double yaw_error_deg = 10;      ///< expected
  double voxel_m = 0.05;          ///< of the finest level
  double overlap_min = 0.3;       ///< less shared surface is no evidence
  int threads = 0;

  void declare(OptionTable& table);
};

/// What is known of one pair of scans after aligning it.
struct PairAlignment {
  size_t target = 0, source = 0;  ///< indices into the scan set
  Isometry3d target_from_source = Isometry3d::Identity();
  Eigen::Matrix<double, 6, 6> information = Eigen::Matrix<double, 6, 6>::Zero();  ///< x y z roll pitch yaw
  double overlap = 0;     ///< part of the smaller scan's visible surface that the other one has, too
  double rmse_m = 0;      ///< over the overlap
  double degeneracy = 0;  ///< smallest over largest eigenvalue of the scaled Hessian
  double conflict = 0;    ///< part of the points that stand in space that the other scan saw to be free
  bool trusted = false;
  std::string reason;  ///< in words, why or why not
};

struct RegistrationResult {
  std::vector<Isometry3d> map_from_scan;  ///< one per scan
  std::vector<bool> connected;            ///< whether a trusted chain of pairs leads to the first scan
  std::vector<PairAlignment> pairs;
  double seconds = 0;

  bool usable() const;
  std::string summary() const;
  Json report() const;
};

/// Aligns one pair from an initial guess, coarse to fine.
PairAlignment align(const Scan& target, const Scan& source, const Isometry3d& target_from_source,
                    const RegistrationOptions& options);

/// All overlapping pairs, then a pose graph with robust loss; the first scan stays where it is. Scans without
/// a trusted connection keep their pose and are named.
RegistrationResult register_scans(const ScanSet& scans, const RegistrationOptions& options,
                                  Progress& progress);

/// Adds scans one by one as a robot takes them: what was aligned before is not aligned again.
class IncrementalRegistration {
 public:
  explicit IncrementalRegistration(const RegistrationOptions& options);
  ~IncrementalRegistration();

  /// Aligns the scan with those before it that it overlaps and solves the graph; poses of all may change.
  const RegistrationResult& add(const Scan& scan);
  const RegistrationResult& result() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace loci
