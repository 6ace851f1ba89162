#pragma once

#include <filesystem>

#include "mapping/base/options.h"
#include "mapping/base/progress.h"
#include "mapping/base/text/json_fwd.h"

namespace loci::apps::fleet_experiment {

struct FleetOptions {
  int robots = 20;
  int observations = 50000;  ///< of each robot
  int seed = 1;
  int users = 10;        ///< at the same time
  int questions = 1000;  ///< of each user
  int lag_scenes = 60;   ///< of a robot that is followed, one each `lag_scene_s`
  double lag_scene_s = 0.25;

  void declare(OptionTable& table);
};

struct FleetFigures {
  int robots = 0;
  int64_t observations = 0, rows = 0;
  double push_wall_s = 0, push_client_s = 0, push_server_s = 0;  ///< of all robots, one after the other
  double again_ms = 0;                                           ///< a push without news, median
  double pull_wall_s = 0;                                        ///< first replicas of all robots
  double question_median_ms = 0, question_p99_ms = 0, question_cpu_p99_ms = 0;
  double questions_per_s = 0;
  double lag_median_s = 0, lag_p99_s = 0, lag_max_s = 0;
};

/// Simulates the memories below `folder` (those that are there are used), pushes them into the database,
/// which must be empty and on this machine, and asks replicas.
FleetFigures measure(const FleetOptions& options, const std::string& url, const std::filesystem::path& folder,
                     Progress& progress);

std::string text_of(const FleetFigures& figures);
Json json_of(const FleetFigures& figures);

}  // namespace loci::apps::fleet_experiment
