#pragma once

#include <map>
#include <string>
#include <vector>

#include "apps/evaluate/identity/score.h"
#include "mapping/base/progress.h"

namespace loci::apps::identity_experiment {

/// What the next scene is compared with.
enum class Condition {
  own,    ///< A: what the model itself believes
  truth,  ///< B: the last real sighting of each object, linked by the truth
  fresh   ///< C: everything measured just before the actions
};
const char* condition_name(Condition condition);
constexpr Condition kConditions[] = {Condition::own, Condition::truth, Condition::fresh};

struct ExperimentOptions {
  int seed = 1;
  int runs = 20;  ///< of all sequences of each noise level
  std::string noise = "known";
  std::string levels = "0.025,0.05,0.075,0.1";
  std::string conditions = "A,B,C";
  std::string models;  ///< empty = all

  void declare(OptionTable& table);
};

/// One model under one condition at one noise level: all runs together, and each run's success.
struct Cell {
  Score score;
  std::vector<Success> runs;
};

struct ExperimentResult {
  std::vector<double> levels;
  std::vector<Condition> conditions;
  std::vector<std::string> models;
  std::map<std::string, Cell> cells;                   ///< by key()
  std::vector<std::array<int64_t, kActions>> actions;  ///< per level
  int64_t scenes = 0;                                  ///< per level

  static std::string key(Condition condition, const std::string& model, size_t level);
  const Cell& cell(Condition condition, const std::string& model, size_t level) const {
    return cells.at(key(condition, model, level));
  }
};

/// Same options, same result on any number of threads.
ExperimentResult run_experiment(const WorldOptions& world, const ExperimentOptions& options, int threads,
                                Progress& progress);

/// Judges one sequence after another with one model.
Score run_model(Model& model, Condition condition, const std::vector<Sequence>& sequences);

}  // namespace loci::apps::identity_experiment
