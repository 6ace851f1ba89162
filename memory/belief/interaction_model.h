#pragma once

#include <array>
#include <map>
#include <set>
#include <string>

#include "memory/belief/options.h"
#include "memory/belief/parameters.h"

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
    double stayed_on_place = 0, went_elsewhere = 0, carried_off = 0;  ///< of those that were handled
    double short_moves = 0;                                           ///< of those that stayed on their place
    std::map<std::string, double> put_down;                           ///< on each known place
    std::array<RateFactor, kAges> returns{};
    RateFactor first_view, later_view;  ///< arrivals when a place is first observed, and later
    RateFactor clutter;
  };

  InteractionModel() = default;
  explicit InteractionModel(Statistics statistics) : statistics_(std::move(statistics)) {}
  const Statistics& statistics() const { return statistics_; }

  /// Probability that an object was handled between two ages, seconds since it was observed.
  double probability(const InteractionKey& object, double from_age, double to_age,
                     const BeliefOptions& options) const;
  /// After `seconds` the object turned out, with a probability, to have been handled. `own` is its factor.
  void learn_interaction(const InteractionKey& object, RateFactor& own, double seconds, double handled,
                         const BeliefOptions& options);

  /// Share of what is handled in `from` that is put down in `to`; the rest is carried off.
  double moved_to(const std::string& from, const std::string& to) const;
  /// Probability that what was handled and is no longer on its place is elsewhere in the home.
  double elsewhere() const;
  void learn_moved(const std::string& from, const std::string& to, double probability);
  /// Share of short moves among those on one place.
  double short_share() const;
  void learn_short_move(double probability) { statistics_.short_moves += probability; }
  void learn_carried_off(double probability) { statistics_.carried_off += probability; }
  /// An object that was believed to be carried off was found in another place.
  void learn_found_again(const std::string& from, const std::string& to, double probability);

  /// Probability that a gone object is back in a scene, `age` seconds after it was observed last.
  double returns(double age, const BeliefOptions& options) const;
  void learn_returns(double age, double found, const BeliefOptions& options);

  /// Expected number of new objects on a place in a scene, clutter included.
  double arrivals(const std::string& place, const BeliefOptions& options) const;
  /// A place was observed and `found` new objects were on it.
  void learn_arrivals(const std::string& place, double found, const BeliefOptions& options);

  /// Whether the place was observed before.
  bool knows(const std::string& place) const { return statistics_.put_down.contains(place); }
  /// Share of clutter among what is new on a place.
  double clutter_share(const std::string& place, const BeliefOptions& options) const;
  /// A later view showed with which probability something new was clutter.
  void learn_clutter(double probability, const BeliefOptions& options);

  /// Adds statistics of a class from another home.
  void import_class(const std::string& class_name, const RateFactor& elsewhere);
  /// Deletes the statistics, names included, of all classes but these.
  void retain_classes(const std::set<std::string>& class_names);

 private:
  double hazard(const std::array<double, kAges>& prior) const;

  Statistics statistics_;
};

}  // namespace loci::memory::belief
