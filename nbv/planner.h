#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "mapping/base/json.h"
#include "mapping/base/options.h"
#include "mapping/base/random.h"
#include "mapping/occupancy/occupancy.h"
#include "mapping/sensor/laser.h"

namespace loci {

struct PlannerOptions {
  double cell_m = 0.10;
  int orientations = 8;
  double distance_min_m = 1.0;
  double distance_max_m = 4.0;
  double opening_deg = 180;
  double robot_radius_m = 0.30;
  double overlap_wanted = 0.5;
  double gain_weight = 0.5;  ///< 0 = overlap only, 1 = gain only
  int samples = 11;
  double travel_cost_per_m = 0;
  double gain_min = 0;  ///< stop when the best validated view gains less, m² of fringe
  int threads = 0;

  void declare(OptionTable& table);
};

/// Where to scan next, and why.
struct NextView {
  std::optional<PlanarPose> pose;  ///< unset: stop
  std::string reason;              ///< of the stop, or of the choice
  double expected_overlap = 0;     ///< n_o / (n_o + n_f) of the validated view
  double expected_gain = 0;        ///< fringe voxels that would be seen
  size_t fringe_voxels = 0;        ///< in the whole map
  std::vector<PlanarPose> path;    ///< way there on the floor
  Json details;                    ///< samples with scores, times, stopping measures
};

/// Next best view by costmaps (§7.3.1): fringe and occupied voxels vote through a visibility kernel per
/// orientation for planar poses; poses sampled in proportion to C = min(C_F, C_O) are validated by ray
/// casting and scored c · H(n_o, n_f); the best that can be reached wins.
NextView next_view(const OccupancyMap& map, const PlanarPose& robot, const LaserModel& laser,
                   const PlannerOptions& options, Random& random);

}  // namespace loci
