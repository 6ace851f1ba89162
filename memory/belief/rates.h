#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace loci::memory::belief {

/// What may happen to things between two looks.
enum class Change {
  removed,   ///< taken away
  moved,     ///< put somewhere else
  changed,   ///< looks different
  returned,  ///< what was taken away is put down again
  arrived,   ///< something that is not believed in is put down
  initial    ///< something was there before anybody looked
};
constexpr size_t kChanges = 6;

/// How often each happens: per object and unit of the objects' clock (removed, moved, changed, returned), per
/// square metre and unit of the world's clock (arrived), per square metre (initial).
struct ChangeRates {
  std::array<double, kChanges> of{0.5, 0.5, 0.5, 0.25, 0.1, 0.3};

  double& operator[](Change change) { return of[static_cast<size_t>(change)]; }
  double operator[](Change change) const { return of[static_cast<size_t>(change)]; }
  /// In a world where everything happens `factor` times as often; what was there at the start stays.
  ChangeRates times(double factor) const;
};

/// Learns the rates from what the belief itself takes to have happened: events found against events expected,
/// both as probabilities, so that in the end as much is expected as is found (the fixed point of expectation
/// maximisation). What stays in doubt counts for less: a scene that tells nothing makes no rate more certain.
/// Gamma counts; old evidence fades.
class RateLearner {
 public:
  explicit RateLearner(const ChangeRates& prior = {}) : prior_(prior) {}

  /// Present best guess.
  ChangeRates rates() const;

  /// Something happened with probability `found` where `expected` was its probability beforehand; `weight`
  /// where several models of the scene share it. Takes effect with finish_scene().
  void count(Change change, double found, double expected, double weight = 1);
  /// Of many things that could happen at once: `expected` of them.
  void expect(Change change, double expected, double weight = 1);
  /// One that probably happened among those.
  void find(Change change, double probability, double weight = 1);
  void finish_scene();

 private:
  static constexpr double kPriorEvents = 1;      ///< a handful of events overrules the prior
  static constexpr double kMinEvents = 0.2;      ///< no rate becomes zero
  static constexpr double kMemoryScenes = 2000;  ///< after so many scenes evidence counts for 1/e

  ChangeRates prior_;
  std::array<double, kChanges> events_{}, exposure_{};
  /// Of the present scene; variances of the number of events before and after looking.
  struct Sums {
    double found = 0, expected = 0, doubt_before = 0, doubt_after = 0;
  };
  std::array<Sums, kChanges> scene_{};
};

/// How busy the present world is, as a distribution over a few levels: factors on all rates. Each level
/// predicts every scene; which predicts best shows in the evidence. How common each level is is learned over
/// worlds.
class Busyness {
 public:
  Busyness();

  size_t levels() const { return weight_.size(); }
  double factor(size_t level) const;
  double weight(size_t level) const { return weight_[level]; }

  /// Another world, or the same one after a long time.
  void begin_world();
  /// Log probability of the present scene at each level.
  void observe(const std::vector<double>& log_evidence);

 private:
  std::vector<double> common_;  ///< Dirichlet counts
  std::vector<double> weight_;
  bool observed_ = false;
};

}  // namespace loci::memory::belief
