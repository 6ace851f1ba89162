#pragma once

#include <memory>
#include <string>
#include <vector>

#include "mapping/base/options.h"
#include "mapping/base/progress.h"
#include "mapping/base/text/json_fwd.h"
#include "mapping/sensor/scan.h"

namespace loci::mapping {

struct RegistrationOptions {
  std::string method = "plane";    ///< point (§7.3), plane, generalised
  int dof = 3;                     ///< 3: x, y, yaw of a levelled robot; 6: all
  double position_error_m = 0.3;   ///< expected localisation error (σ): the search reaches twice as far
  double yaw_error_deg = 15;       ///< expected (σ)
  double voxel_m = 0.05;           ///< of the finest level
  double min_overlap = 0.3;        ///< less shared surface is no evidence
  double max_conflict = 0.02;      ///< with more points in free space it is another place
  double min_degeneracy = 0.003;   ///< below it the pose may slide or rotate
  double max_rmse_m = 0.03;        ///< beyond it the surfaces are different
  double ambiguity_margin = 0.03;  ///< a second pose must fit worse by this part of the surface
  int threads = 0;  ///< 0 = all cores; not declared as an option: the result is the same on any number

  void declare(OptionTable& table);
};

/// The result of aligning a pair of scans.
struct PairAlignment {
  size_t target = 0, source = 0;  ///< indices into the scan set
  Isometry3d target_from_source = Isometry3d::Identity();
  /// x y z roll pitch yaw of a motion in the target's frame, about its origin.
  Eigen::Matrix<double, 6, 6> information = Eigen::Matrix<double, 6, 6>::Zero();
  double overlap = 0;     ///< part of the smaller scan's visible surface that is in the other one, too
  double rmse_m = 0;      ///< over the overlap
  double degeneracy = 0;  ///< smallest over largest eigenvalue of the scaled Hessian
  double conflict = 0;    ///< part of the points in space that the other scan saw as free
  bool trusted = false;
  bool ambiguous = false;  ///< not trusted, because another pose fits about as well
  std::string reason;      ///< why trusted or not
};

struct RegistrationResult {
  std::vector<std::string> names;         ///< of the scans
  std::vector<Isometry3d> map_from_scan;  ///< one per scan
  /// Whether the scan belongs to the largest group that chains of trusted pairs connect (the earliest of
  /// several). Other scans are placed by odometry, relative to the scan before them (and after them, if that
  /// one is connected).
  std::vector<bool> connected;
  std::vector<PairAlignment> pairs;  ///< that were tried
  double seconds = 0;

  /// Whether the poses improve on the input: there is one scan, or at least one pair is trusted.
  bool usable() const;
  size_t connected_count() const;
  std::string summary() const;
  Json report() const;
};

/// Whether a scan's points can have been seen from its origins: hardly any hides another. A cloud that was
/// merged from several views, or is not in the sensor's frame, is refuted.
bool origins_fit(const Scan& scan);

/// Aligns one pair from an initial guess, coarse to fine: a search over rotations and shifts within twice the
/// expected error, then iterative closest point on the common surface. Does not throw for scans that do not
/// fit: the result is not trusted.
PairAlignment align(const Scan& target, const Scan& source, const Isometry3d& target_from_source,
                    const RegistrationOptions& options);

/// Aligns all overlapping pairs and solves a pose graph with robust loss; the first scan stays. Scans without
/// a trusted connection to the largest group are placed by odometry relative to their neighbours and named.
/// Error for a set without scans.
RegistrationResult register_scans(const ScanSet& scans, const RegistrationOptions& options,
                                  Progress& progress);

/// Adds scans one by one; earlier pairs are not aligned again.
class IncrementalRegistration {
 public:
  explicit IncrementalRegistration(const RegistrationOptions& options);
  ~IncrementalRegistration();

  /// Aligns the scan with earlier ones that it overlaps and solves the graph; all poses may change. The
  /// search starts at the scan's pose, which stays relative to the previous scan while no pair is trusted;
  /// its covariance (if not zero) determines the search window.
  const RegistrationResult& add(const Scan& scan);
  /// Aligns scans that are not connected with the connected ones again, from the poses known by now and
  /// within the window of the options.
  const RegistrationResult& retry();
  const RegistrationResult& result() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace loci::mapping
