#pragma once

#include <array>
#include <map>
#include <vector>

#include "apps/evaluate/identity/model.h"

namespace loci::apps::identity_experiment {

/// How many were right.
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

/// Everything that is counted of one model in one condition at one noise level.
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

/// What is true of one scene, relative to what is believed.
struct SceneTruth {
  std::vector<std::optional<size_t>> partner_of_seen, partner_of_old;
  std::vector<memory::Explanation> seen, old;
};

/// A believed object with what the simulator knows about its last measurement.
struct Believed {
  Entry entry;
  Origin origin;
};

SceneTruth truth_of(const SimulatedScene& scene, const std::vector<Believed>& believed);

void count_scene(const SimulatedScene& scene, int actions, const std::vector<Believed>& believed,
                 const SceneTruth& truth, const Judgement& judgement, Score& score);

}  // namespace loci::apps::identity_experiment
