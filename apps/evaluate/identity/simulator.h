#pragma once

#include <array>
#include <vector>

#include "mapping/base/math/random.h"
#include "mapping/base/options.h"
#include "memory/identity/solution.h"

namespace loci::apps::identity_experiment {

/// What the simulated world is like: tables of 1 m × 1 m, objects that people put there, move, change and
/// take away, and a sensor that sees a strip of one table at a time (dissertation, section 6.3).
struct WorldOptions {
  double appear = 0.3412;  ///< proportions of table 6.3
  double disappear = 0.3223;
  double move = 0.1874;
  double newview = 0.1490;
  int tables = 4;
  int objects = 15;
  double view_m = 1.0;
  int start_objects = -1;  ///< there before the first step; negative = a third of the limit, rounded down
  int steps = 20;
  int min_objects = 3, max_objects = 10;
  int min_actions = 1, max_actions = 5;

  void declare(OptionTable& table);
};

/// Measurement of one object.
struct Measurement {
  int table = 0;
  Eigen::Vector2d position = Eigen::Vector2d::Zero();  ///< metres from the table's corner
  Eigen::Vector3d color = Eigen::Vector3d::Zero();     ///< each channel 0 to 1 but for the noise
};

/// Ground truth of a measurement; no model sees it.
struct Origin {
  int object = 0;
  Eigen::Vector2d position = Eigen::Vector2d::Zero();  ///< true
  int table = 0;
  int placements = 0;   ///< how often the object had been put somewhere
  int appearances = 0;  ///< how often its colour had changed
};

struct SimulatedObservation {
  Measurement seen;
  Origin origin;
};

/// Field of view: a strip across a table.
struct View {
  int table = 0;
  double centre = 0.5;  ///< along the table, metres
  double half = 0.5;

  bool contains(int at_table, double x) const { return at_table == table && std::abs(x - centre) <= half; }
};

enum class Action { appear, disappear, move, newview };
constexpr size_t kActions = 4;

struct SimulatedScene {
  View view;
  std::vector<SimulatedObservation> seen;
  std::vector<SimulatedObservation> before;  ///< all present objects, measured before the actions
  std::array<int, kActions> actions{};       ///< how many of each
  int present = 0;                           ///< objects after the actions
};

/// One run of the dissertation: an empty belief and then a number of steps.
struct Sequence {
  int limit = 0;    ///< of objects at a time
  int actions = 0;  ///< per step
  std::vector<SimulatedScene> scenes;
};

int start_objects(const WorldOptions& options, int limit);

/// Standard deviation `sigma` of each measured number.
Sequence simulate(const WorldOptions& options, int limit, int actions, double sigma, Random random);

/// All sequences of one noise level: every object limit with every number of actions.
std::vector<Sequence> simulate_level(const WorldOptions& options, double sigma, const Random& random);

}  // namespace loci::apps::identity_experiment
