#pragma once

#include <string>
#include <vector>

#include "mapping/base/options.h"
#include "mapping/base/progress.h"
#include "mapping/base/text/json_fwd.h"

namespace loci::apps::filter_evaluation {

struct SpeedOptions {
  int meshes = 10000;
  int robots = 35;
  double min_half_m = 0.02;
  double max_half_m = 0.08;
  int repeats = 10;
  int steps = 5;
  bool reference = true;
  int seed = 1;

  void declare(OptionTable& table);
};

/// The best of the repeats, milliseconds.
struct Time {
  double clock_ms = 0, processor_ms = 0;
};

/// So many instances in view, drawn.
struct CrowdTimes {
  int meshes = 0;
  Time one, two;            ///< threads
  Time all;                 ///< two threads, nothing passed over; once
  bool same_pixels = true;  ///< without culling; on one and two threads
  Time rays;                ///< Embree, single rays, one thread
  double tree_ms = 0;       ///< Embree's tree over the instances
  int different = 0;        ///< pixels more than 2 mm apart from the rays'
};

/// So many robots, each with a joint state of its own in every image.
struct RobotTimes {
  int robots = 0;
  Time update;  ///< joint states to poses of links
  Time draw;    ///< two threads
};

struct Speed {
  std::vector<CrowdTimes> crowds;
  std::vector<RobotTimes> robots;

  std::string text() const;
  Json to_json() const;
};

/// Times the renderer as §4.2.2.2 does, 640 × 480: robots with joints (Fig. 4.15) and meshes at random poses
/// in view (Fig. 4.16), beside Embree's rays in the same run.
Speed measure_speed(const SpeedOptions& options, Progress& progress);

/// Both figures as one image.
std::string speed_svg(const Speed& speed);

}  // namespace loci::apps::filter_evaluation
