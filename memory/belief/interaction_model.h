#pragma once

#include <array>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "memory/belief/options.h"
#include "memory/belief/parameters.h"
#include "memory/belief/place_history.h"

namespace loci::memory::belief {

/// Events found over events expected, with a prior of a few events at the expected rate.
struct RateFactor {
  double found = 0, expected = 0;

  double value() const { return (found + kParameters.prior_events) / (expected + kParameters.prior_events); }
  void count(double found_now, double expected_now) {
    found += found_now;
    expected += expected_now;
  }
};

/// What the rate of handling of an object depends on.
struct InteractionKey {
  std::string class_name;  ///< empty = unknown
  std::string place;       ///< empty = unknown
  RateFactor own = {};     ///< of the object itself, stored with the object
  double uses = 0;         ///< of its place (ProtoObject::uses)
};

/// How objects are handled in this home: how long they stay, by the time since they were observed, class,
/// place and object; where they are moved; how often new ones appear. Learned from the events that the belief
/// infers; without evidence it is what the options say.
class InteractionModel {
 public:
  static constexpr size_t kAges = 7;

  /// Sufficient statistics.
  struct Statistics {
    std::array<RateFactor, kAges> by_age{};
    std::map<std::string, RateFactor> by_class, by_place;
    RateFactor by_use;  ///< of what lies on a place, when that is opened, shut or moved
    /// What was handled is put down on its place or on another one, or carried off.
    RateFactor within, elsewhere, off;
    double short_moves = 0, moves_within = 0;  ///< of those on their place
    std::map<std::string, double> put_down;    ///< on each known place
    std::array<RateFactor, kAges> returns{};
    RateFactor first_view, later_view;     ///< arrivals when a place is first observed, and later …
    double views = 0, unseen_seconds = 0;  ///< … in views after this time in which nobody looked
    RateFactor clutter;
    RateFactor changes;  ///< of appearance at the same spot
  };

  InteractionModel() = default;
  explicit InteractionModel(Statistics statistics) : statistics_(std::move(statistics)) {}
  const Statistics& statistics() const { return statistics_; }

  /// Probability that an object was handled between two ages, seconds since it was observed.
  double probability(const InteractionKey& object, double from_age, double to_age,
                     const BeliefOptions& options) const;
  /// The object turned out, with a probability, to have been handled between two ages. `own` is its factor,
  /// `weight` the probability that anything turned out.
  void learn_interaction(const InteractionKey& object, RateFactor& own, double from_age, double to_age,
                         double handled, double weight, const BeliefOptions& options);

  /// Share of what is handled in `from` that is put down in `to`; the rest is carried off.
  double moved_to(const std::string& from, const std::string& to) const;
  /// The same for all of `places`.
  std::vector<double> destinations(const std::string& from, const PlaceHistories& places) const;
  /// Probability that what was handled and is no longer on its place is elsewhere in the home.
  double elsewhere() const;
  /// Moves that were found against those that were expected of what was observed, as probabilities.
  void learn_moved(const std::string& from, const std::string& to, double found, double expected);
  void learn_carried_off(double found, double expected) { learn(statistics_.off, found, expected); }
  /// Share of short moves among those on one place.
  double short_share() const;
  /// A move on one place, with a probability, and with another one a short one.
  void learn_short_move(double moved, double short_one);

  /// Factor on the probability of another appearance at the same spot.
  double change_factor() const { return statistics_.changes.value(); }
  void learn_change(double found, double expected) { learn(statistics_.changes, found, expected); }

  /// Probability that a gone object is back in a scene, `age` seconds after it was observed last.
  double returns(double age, const BeliefOptions& options) const;
  void learn_returns(double age, double found, const BeliefOptions& options);

  /// Expected number of new objects on a place in a scene, clutter included: what was there before the first
  /// view, and what came in the time in which nobody looked, relative to the mean of that time.
  double arrivals(const PlaceView& place, const BeliefOptions& options) const;
  /// A place was observed and `found` new objects were on it.
  void learn_arrivals(const PlaceView& place, double found, const BeliefOptions& options);

  /// Whether the place was observed before.
  bool knows(const std::string& place) const { return statistics_.put_down.contains(place); }
  /// Share of clutter among what is new on a place.
  double clutter_share(const std::string& place, double arrivals, const BeliefOptions& options) const;
  /// A later view showed with which probability something new was clutter.
  void learn_clutter(double probability, const BeliefOptions& options);

  /// Adds statistics of a class from another home.
  void import_class(const std::string& class_name, const RateFactor& elsewhere);
  /// Deletes the statistics, names included, of all classes but these.
  void retain_classes(const std::set<std::string>& class_names);

 private:
  double hazard(const std::array<double, kAges>& prior) const;
  double hazard_of_uses(const InteractionKey& object) const;
  double outcome_share(const RateFactor& outcome, bool alone) const;
  /// How much was put down on all places but one.
  double put_down_beside(const std::string& from) const;
  double destination_share(const std::string& from, const std::string& to, double beside) const;
  double relative_gap(double unseen_seconds) const;
  /// `expected` includes the factor.
  static void learn(RateFactor& factor, double found, double expected) {
    factor.count(found, expected / factor.value());
  }

  Statistics statistics_;
};

}  // namespace loci::memory::belief
