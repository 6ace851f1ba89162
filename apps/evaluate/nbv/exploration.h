#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "apps/evaluate/nbv/strategies.h"
#include "apps/evaluate/nbv/truth.h"
#include "mapping/base/progress.h"
#include "mapping/simulation/simulated_robot.h"

namespace loci::apps::nbv_evaluation {

struct ExplorationOptions {
  int starts = 5;
  int seed = 1;
  int max_scans = 20;
  double exhaustive_s = 20;
  double goal = 0.98;
  int threads = 0;
  std::optional<double> ceiling;  ///< height of one to add, metres
  std::vector<std::string> planners = planner_names();
  nbv::PlannerOptions planner;
  mapping::OccupancyOptions occupancy;

  void declare(OptionTable& table);
};

/// One exploration: a strategy from a start.
struct Run {
  std::string strategy;
  mapping::PlanarPose start;
  std::vector<double> coverage;     ///< after each scan
  std::vector<double> seconds;      ///< of each decision
  std::vector<double> cpu_seconds;  ///< of each decision, all threads
  std::vector<double> overlap;      ///< expected of each chosen view
  bool stopped = false;             ///< by its own rule, not by max_scans
  bool cut = false;                 ///< a decision was cut by the time limit

  /// Scans until the coverage was reached; 0 = never.
  int scans_to(double goal) const;
};

struct WorldResult {
  std::string world;
  size_t places = 0, surface = 0;  ///< of the truth
  std::vector<Run> runs;
};

/// Explores a world with every strategy from several random starts, with true poses.
WorldResult explore(const std::filesystem::path& urdf,
                    const std::vector<std::filesystem::path>& package_paths,
                    const ExplorationOptions& options, Progress& progress, Warnings& warnings);

std::string table_of_results(const std::vector<WorldResult>& results, double goal);
Json json_of_results(const std::vector<WorldResult>& results, double goal);
/// Coverage against number of scans, mean over starts, one panel per world.
std::string coverage_svg(const std::vector<WorldResult>& results, double goal);

}  // namespace loci::apps::nbv_evaluation
