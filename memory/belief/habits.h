#pragma once

#include <array>
#include <map>
#include <set>
#include <string>

#include "memory/belief/options.h"

namespace loci::memory::belief {

/// How often something happened against how often it was expected to: learned with a prior of a few events at
/// the expected rate, so that little evidence says little.
struct Factor {
  double found = 0, expected = 0;

  double value() const { return (found + kPrior) / (expected + kPrior); }
  void count(double what_was_found, double what_was_expected) {
    found += what_was_found;
    expected += what_was_expected;
  }
  template <class Archive>
  void archive(Archive& fields) {
    fields(found, expected);
  }

 private:
  static constexpr double kPrior = 2;
};

/// Whose habits are asked for. The object's own factor is kept by whoever keeps the object.
struct Handled {
  std::string kind;   ///< what a classifier says; empty = unknown
  std::string place;  ///< where it is; empty = unknown
  Factor own = {};
};

/// How things are handled in this home, learned from what the belief itself takes to have happened: how long
/// they stay, by the time since they were seen, kind, place and object; where they go; how often something
/// new turns up. Begins with what the options say and stays near them until there is evidence.
class Habits {
 public:
  /// Probability that somebody moved or took an object between two ages, seconds since it was seen.
  double handled(const Handled& object, double from_age, double to_age, const BeliefOptions& options) const;
  /// After `seconds` it turned out, with a probability, to have been handled. `own` is the object's factor.
  void learn_handled(const Handled& object, Factor& own, double seconds, double handled,
                     const BeliefOptions& options);

  /// Share of what is handled in `from` that is put down in `to`; the rest is carried off.
  double moved_to(const std::string& from, const std::string& to) const;
  void learn_moved(const std::string& from, const std::string& to, double probability);
  void learn_carried_off(double probability) { carried_off_ += probability; }
  /// What was taken for carried off turned up in another place.
  void learn_found_again(const std::string& from, const std::string& to, double probability);

  /// Probability that an object that was gone is back in a scene, `age` seconds after it was seen last.
  double returns(double age, const BeliefOptions& options) const;
  void learn_returns(double age, double found, const BeliefOptions& options);

  /// New things expected on a place in a scene, false clusters included.
  double arrivals(const std::string& place, const BeliefOptions& options) const;
  /// A place was looked at and `found` new things were on it.
  void learn_arrivals(const std::string& place, double found, const BeliefOptions& options);

  /// What was learned of kinds of things.
  const std::map<std::string, Factor>& kinds() const { return by_kind_; }
  /// Counts what was learned of a kind elsewhere as if it had happened here.
  void take_kind(const std::string& kind, const Factor& elsewhere) {
    by_kind_[kind].count(elsewhere.found, elsewhere.expected);
  }

  /// Drops what was learned of kinds but these, down to their names.
  void keep_kinds(const std::set<std::string>& kinds) {
    std::erase_if(by_kind_, [&](const auto& of_kind) { return !kinds.contains(of_kind.first); });
  }

  bool knows(const std::string& place) const { return put_down_.contains(place); }
  /// Of what is new on a place that was looked at before, the share that are false clusters.
  double false_share(const std::string& place, const BeliefOptions& options) const;
  /// Another look showed with which probability something new was a false cluster.
  void learn_false(double probability, const BeliefOptions& options);

  /// The fields, for an archive (archive.h).
  template <class Archive>
  void archive(Archive& fields) {
    fields(by_age_, by_kind_, by_place_, stayed_on_place_, went_elsewhere_, carried_off_, put_down_, returns_,
           first_look_, later_look_, false_);
  }
  /// The same before returns were told apart by age, and false clusters were learned of.
  template <class Archive>
  void archive_before_4(Archive& fields) {
    fields(by_age_, by_kind_, by_place_, stayed_on_place_, went_elsewhere_, carried_off_, put_down_,
           returns_.front(), first_look_, later_look_);
    returns_.fill({returns_.front().found / kAges, returns_.front().expected / kAges});
  }

 private:
  static constexpr size_t kAges = 7;

  /// How much handling is expected without evidence between two ages, by age.
  static std::array<double, kAges> prior_hazard(double from_age, double to_age, const BeliefOptions& options);
  double hazard(const std::array<double, kAges>& prior) const;
  double factor(const std::map<std::string, Factor>& factors, const std::string& name) const;

  std::array<Factor, kAges> by_age_{};
  std::map<std::string, Factor> by_kind_, by_place_;
  double stayed_on_place_ = 0, went_elsewhere_ = 0, carried_off_ = 0;  ///< of those that were handled
  std::map<std::string, double> put_down_;                             ///< on each known place
  std::array<Factor, kAges> returns_{};
  Factor first_look_, later_look_, false_;
};

}  // namespace loci::memory::belief
