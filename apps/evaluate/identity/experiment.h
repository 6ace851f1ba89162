#pragma once

#include <array>
#include <map>
#include <string>
#include <vector>

#include "apps/evaluate/identity/models.h"
#include "mapping/base/progress.h"

namespace loci::apps::identity_experiment {

/// Accuracy count.
struct Tally {
  int64_t right = 0, total = 0;

  void add(bool is_right) {
    right += is_right ? 1 : 0;
    ++total;
  }
  void operator+=(const Tally& other) {
    right += other.right;
    total += other.total;
  }
  double fraction() const { return total == 0 ? 1.0 : double(right) / double(total); }
};

struct Success {
  Tally association, explanation;
  void operator+=(const Success& other) {
    association += other.association;
    explanation += other.explanation;
  }
};

/// Stated probabilities of the answers against how often they were right, in ten bins.
struct Calibration {
  struct Bin {
    double stated = 0;
    Tally answers;
    double mean_stated() const { return answers.total == 0 ? 0 : stated / double(answers.total); }
    /// Two binomial standard errors and one point.
    double allowed() const;
    bool holds() const { return std::abs(mean_stated() - answers.fraction()) <= allowed(); }
  };
  std::array<Bin, 10> bins{};
  void add(double probability, bool right);
  void operator+=(const Calibration& other);
};

/// Mean and deviation of errors of the evidence.
struct ErrorSum {
  double sum = 0, squares = 0;
  int64_t count = 0;
  void add(double error) {
    sum += error;
    squares += error * error;
    ++count;
  }
  void operator+=(const ErrorSum& other) {
    sum += other.sum;
    squares += other.squares;
    count += other.count;
  }
  double mean() const { return count == 0 ? 0 : sum / double(count); }
  double deviation() const;
};

/// Results of one model in one condition at one noise level.
struct Score {
  Success all, of_new, of_old, whole_scenes;
  std::map<int, Success> by_objects, by_actions;
  /// Rows truth, columns answer: newview, move, hidden, disappear, stay; stay, move, newview, appear.
  std::array<std::array<int64_t, 5>, 5> old_confusion{};
  std::array<std::array<int64_t, 4>, 4> new_confusion{};
  Calibration association, explanation;
  ErrorSum same_position, same_color, other_position, other_color;  ///< of the evidence (table 6.2)

  void operator+=(const Score& other);
};

/// Ground truth of one scene, relative to a belief.
struct SceneTruth {
  std::vector<std::optional<size_t>> partner_of_seen, partner_of_old;
  std::vector<memory::Explanation> seen, old;
};

/// A believed object with the ground truth of its last measurement.
struct Believed {
  Entry entry;
  Origin origin;
};

SceneTruth truth_of(const SimulatedScene& scene, const std::vector<Believed>& believed);

void count_scene(const SimulatedScene& scene, int actions, const std::vector<Believed>& believed,
                 const SceneTruth& truth, const Judgement& judgement, Score& score);

/// Belief that the next scene is compared with.
enum class Condition {
  own,    ///< A: the belief of the model itself
  truth,  ///< B: the last real observation of each object, linked by the truth
  fresh   ///< C: everything measured just before the actions
};
const char* condition_name(Condition condition);
constexpr Condition kConditions[] = {Condition::own, Condition::truth, Condition::fresh};

struct ExperimentOptions {
  int seed = 1;
  int runs = 20;  ///< of all sequences of each noise level
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

/// How long one problem takes to solve exactly on one core.
struct SpeedRow {
  std::string problem;
  double milliseconds = 0;  ///< CPU time, best of the repetitions
  double aim_milliseconds = 0;
  double gate_bound = 0;  ///< largest error of a probability
};

/// Weights, marginals and the most probable matching, as every scene needs them.
std::vector<SpeedRow> measure_speed(int seed);

}  // namespace loci::apps::identity_experiment
