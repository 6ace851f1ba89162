#pragma once

// Model of the changes of a simulated world, used by the experiment only.

#include <array>
#include <cstddef>
#include <vector>

namespace loci::apps::identity_experiment {

/// Changes between two views.
enum class Change {
  removed,   ///< taken away
  moved,     ///< put somewhere else
  changed,   ///< changes its appearance
  returned,  ///< an object that was taken away is put down again
  arrived,   ///< an object without track is put down
  initial    ///< an object was there before the first view
};
constexpr size_t kChanges = 6;

/// Rates: per object and unit of its exposure (removed, moved, changed, returned), per square metre and unit
/// of time (arrived), per square metre (initial).
struct ChangeRates {
  std::array<double, kChanges> of{0.5, 0.5, 0.5, 0.25, 0.1, 0.3};

  double& operator[](Change change) { return of[static_cast<size_t>(change)]; }
  double operator[](Change change) const { return of[static_cast<size_t>(change)]; }
  /// Rates at an activity level; the initial density stays.
  ChangeRates times(double factor) const;
};

/// Learns the rates from the inferred changes: events found against events expected, both as probabilities,
/// with the fixed point of expectation maximisation. Uncertain events count less: a scene without information
/// makes no rate more certain. Gamma counts; old evidence fades.
class RateLearner {
 public:
  explicit RateLearner(const ChangeRates& prior = {}) : prior_(prior) {}

  /// Posterior mean.
  ChangeRates rates() const;

  /// Posterior and prior probability of an event; `weight` where several models share the scene. Takes effect
  /// with finish_scene().
  void count(Change change, double found, double expected, double weight = 1);
  /// Expected number of events.
  void expect(Change change, double expected, double weight = 1);
  /// Probability of one of them.
  void find(Change change, double probability, double weight = 1);
  void finish_scene();

 private:
  static constexpr double kPriorEvents = 1;      ///< a handful of events overrules the prior
  static constexpr double kMinEvents = 0.2;      ///< no rate becomes zero
  static constexpr double kMemoryScenes = 2000;  ///< after so many scenes evidence counts for 1/e

  ChangeRates prior_;
  std::array<double, kChanges> events_{}, exposure_{};
  /// Of the present scene; variances of the number of events.
  struct Sums {
    double found = 0, expected = 0, prior_variance = 0, posterior_variance = 0;
  };
  std::array<Sums, kChanges> scene_{};
};

/// Activity in the present world: a distribution over a few levels, which are factors on all rates. Each
/// level predicts every scene and is weighted by the evidence; the prior of the levels is learned over
/// worlds.
class ActivityLevel {
 public:
  ActivityLevel();

  size_t levels() const { return weight_.size(); }
  double factor(size_t level) const;
  double weight(size_t level) const { return weight_[level]; }

  /// Starts another world.
  void begin_world();
  /// Log probability of the present scene at each level.
  void observe(const std::vector<double>& log_evidence);

 private:
  std::vector<double> common_;  ///< Dirichlet counts
  std::vector<double> weight_;
  bool observed_ = false;
};

/// Interaction model: probabilities that an object was handled between two views, and how. At most once.
struct Interactions {
  double removed = 0, moved = 0, changed = 0;
  double returned = 0;  ///< of an object that had been taken away

  double untouched() const { return 1 - removed - moved - changed; }
};

/// For `exposure` units of the object's exposure.
Interactions interactions(const ChangeRates& rates, double exposure);

/// Location belief of an unobserved object. Places are divided into cells of equal size. The masses sum to
/// one with the probability of being unrecognisable (moved and changed).
struct LocationBelief {
  double here = 1;                ///< unchanged, at its last location
  double changed = 0;             ///< at its last location, with another appearance
  double gone = 0;                ///< taken away
  double moved = 0;               ///< moved elsewhere; by cell below
  double returned = 0;            ///< taken away and returned elsewhere; by cell below
  std::vector<double> elsewhere;  ///< per cell; empty = nowhere

  double present() const { return here + changed + moved + returned; }
};

/// Undetected-object intensity: expected number of objects without track per cell, by origin.
struct UndetectedIntensity {
  std::vector<double> arrived, initial, lost;

  explicit UndetectedIntensity(size_t cells = 0)
      : arrived(cells, 0.0), initial(cells, 0.0), lost(cells, 0.0) {}
  double at(size_t cell) const { return arrived[cell] + initial[cell] + lost[cell]; }
  double sum() const;
};

/// Prediction of one object. Mass that becomes unrecognisable is added to `undetected.lost`.
void predict(LocationBelief& object, const Interactions& interactions, size_t cells,
             UndetectedIntensity& undetected);

/// Prediction of undetected objects; `arrivals` per cell.
void predict(UndetectedIntensity& undetected, const Interactions& interactions, double arrivals);

/// Update of an object that was not observed: `in_view` is the probability that its last location was in
/// view, `seen[cell]` the share of the cell that was. Returns the likelihood.
double observe_absence(LocationBelief& object, double in_view, const std::vector<double>& seen);

/// Update of undetected objects: all objects in view have tracks from now on.
void observe(UndetectedIntensity& undetected, const std::vector<double>& seen);

/// Estimates the variance of measurements from pairs that are probably the same and unchanged. Old evidence
/// fades.
class NoiseEstimate {
 public:
  /// Starts from an upper bound: a low one would take noise for change.
  explicit NoiseEstimate(double start_sigma);
  /// Fixed.
  static NoiseEstimate known(double sigma);

  double variance() const { return squares_ / count_; }
  /// `difference` of a measurement to a mean of `views` measurements, which are the same with `probability`.
  void count(double difference, double views, double probability);

 private:
  static constexpr double kMemory = 300;  ///< differences after which evidence counts for 1/e
  bool known_ = false;
  double squares_ = 0, count_ = 0;
};

}  // namespace loci::apps::identity_experiment
