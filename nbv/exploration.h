#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "mapping/base/options.h"
#include "mapping/base/progress.h"
#include "mapping/base/text/json_fwd.h"
#include "mapping/occupancy/occupancy.h"
#include "mapping/registration/registration.h"
#include "mapping/sensor/robot.h"
#include "nbv/inspection.h"
#include "nbv/planner.h"

namespace loci::nbv {

struct ExplorationOptions {
  int max_scans = 40;
  int max_failures = 5;  ///< goals in a row that the robot could not reach
  PlannerOptions planner;
  InspectionOptions inspection;
  mapping::OccupancyOptions occupancy;
  mapping::RegistrationOptions registration;
  mapping::LaserModel laser;
  std::string height = {};  ///< scanner_heights()
  uint64_t seed = 1;
  int threads = 0;  ///< of all stages; 0 = all cores; not declared: the result is the same on any number

  ExplorationOptions() {
    planner.travel_cost_per_m = 0.1;
    planner.min_view_overlap = 0.15;
  }

  void declare(OptionTable& table);
  /// Gives `threads` to the options of all stages.
  void forward_threads();
};

/// The heights from which a robot scans, metres: as it carries the scanner, and both ends of the range
/// "LOW..HIGH" in which it can move it; the first alone where `range` is empty. Error for anything but a
/// range around that height.
std::vector<double> scanner_heights(const std::string& range, double carried);

/// One scan of an exploration: its reason and its result.
struct ExplorationStep {
  mapping::PlanarPose goal;
  double height = 0;                                           ///< of the scanner
  Isometry3d map_from_scan_odometry = Isometry3d::Identity();  ///< as the robot believed before registration
  std::string reason;
  double expected_overlap = 0;  ///< of the plan, unset (0) for the first scan
  double expected_gain = 0;
  double reached_overlap = 0;  ///< by registration, with the best of the scans before
  size_t known_voxels = 0;     ///< free and occupied leaves of the pruned octree after this scan
  size_t frontier_voxels = 0;  ///< left, when the next view was planned
  double scan_seconds = 0, register_seconds = 0, insert_seconds = 0, plan_seconds = 0;
};

/// Scans a room until nothing is gained: scan, register, insert, plan; first what is unknown, then faces of
/// furniture that were seen too coarsely. Every step is a checkpoint in its
/// folder: `scans/` (poses as far as they are known) and `explore.json`; at most the scan in progress is
/// lost.
class Exploration {
 public:
  /// With `resume`, goes on from what is in the folder (Error when that was made with other options);
  /// otherwise begins anew.
  Exploration(mapping::Robot& robot, const mapping::PlanarPose& start, std::filesystem::path folder,
              bool resume, const ExplorationOptions& options, Warnings& warnings);
  ~Exploration();

  /// Scans until the planner stops. Interrupted leaves a checkpoint.
  void run(Progress& progress);

  /// Called with every plan, the step that it follows, and where the robot stood: for images.
  using Watcher = std::function<void(size_t step, const ViewPlan&, const mapping::PlanarPose& robot)>;
  void watch_plans(Watcher watcher);

  /// All scans, at their registered poses; those that could not be registered are left out (and named).
  mapping::ScanSet registered_scans() const;
  /// Where another scan was taken, by the scans near it; unset when none of them can be trusted.
  std::optional<Isometry3d> locate(const mapping::Scan& scan) const;
  const mapping::OccupancyMap& occupancy() const;
  const mapping::RegistrationResult& registration() const;
  const std::vector<ExplorationStep>& steps() const;
  const std::string& stop_reason() const;
  Json report() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace loci::nbv
