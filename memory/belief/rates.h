#pragma once

#include <array>
#include <cstddef>

namespace loci::belief {

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
};

/// Learns the rates from what the belief itself takes to have happened: counts of events against the number
/// expected, both as probabilities, so that in the end as much is expected as is found (the fixed point of
/// expectation maximisation). Two levels: rates that hold everywhere, and how busy this world is just now,
/// which multiplies all of them but `initial` (conjugate Gamma counts). Old evidence fades.
class RateLearner {
 public:
  explicit RateLearner(const ChangeRates& prior = {});

  /// Another world, or the same one after a long time: how busy it is has to be learned anew.
  void begin_world();

  /// Present best guess.
  ChangeRates rates() const;
  double busyness() const { return (kBusynessShape + busy_events_) / (kBusynessShape + busy_expected_); }

  /// Something happened with probability `events` where `expected` was its probability under rates(). Takes
  /// effect with finish_scene().
  void count(Change change, double events, double expected);
  void finish_scene();

 private:
  /// A prior that a handful of events overrules.
  static constexpr double kPriorEvents = 1;
  /// Busyness scatters by about one half from world to world.
  static constexpr double kBusynessShape = 4;
  /// After so many scenes evidence counts for 1/e.
  static constexpr double kMemoryScenes = 2000;

  ChangeRates prior_;
  std::array<double, kChanges> events_{}, exposure_{};
  std::array<double, kChanges> scene_events_{}, scene_expected_{};
  double busy_events_ = 0, busy_expected_ = 0;
};

}  // namespace loci::belief
