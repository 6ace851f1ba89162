#include "memory/belief/habits.h"

#include <algorithm>
#include <cmath>

namespace loci::memory::belief {
namespace {

/// Seconds since an object was seen at which the next age begins.
constexpr std::array<double, 6> kAgeBegins{300, 1200, 3600, 4 * 3600, 24 * 3600, 7 * 24 * 3600};

/// Without evidence a third of what is handled is carried off, the others are put down, on their place as
/// often as on another one.
constexpr double kCarriedOff = 1, kPutDown = 2;

/// Integrated rate of handling that the options state, with a slow tail: nothing stays forever.
double cumulative_hazard(double seconds, const BeliefOptions& options) {
  const double soon = options.move_cap * (1 - std::exp(-seconds / options.move_time_s));
  return -std::log(1 - soon) + 0.15 * std::log1p(seconds / (24 * options.move_time_s));
}

size_t age_of(double seconds) {
  const auto end = std::ranges::upper_bound(kAgeBegins, seconds);
  return static_cast<size_t>(end - kAgeBegins.begin());
}

/// Mean share of an interval that had gone by when something happened in it at a constant rate.
double elapsed_share(double hazard) {
  return hazard < 1e-3 ? 0.5 : 1 / hazard - 1 / std::expm1(hazard);
}

}  // namespace

std::array<double, Habits::kAges> Habits::prior_hazard(double from_age, double to_age,
                                                       const BeliefOptions& options) {
  std::array<double, kAges> parts{};
  double begin = std::max(0.0, from_age);
  if (to_age <= begin) return parts;
  double before = cumulative_hazard(begin, options);
  for (size_t age = 0; age < kAges && begin < to_age; ++age) {
    const double end = age < kAgeBegins.size() ? std::min(to_age, kAgeBegins[age]) : to_age;
    if (end <= begin) continue;
    const double now = cumulative_hazard(end, options);
    parts[age] = now - before;
    before = now;
    begin = end;
  }
  return parts;
}

double Habits::hazard(const std::array<double, kAges>& prior) const {
  double sum = 0;
  for (size_t age = 0; age < kAges; ++age) sum += by_age_[age].value() * prior[age];
  return sum;
}

double Habits::factor(const std::map<std::string, Factor>& factors, const std::string& name) const {
  const auto found = factors.find(name);
  return found == factors.end() ? 1.0 : found->second.value();
}

double Habits::handled(const Handled& object, double from_age, double to_age,
                       const BeliefOptions& options) const {
  const double by_age = hazard(prior_hazard(from_age, to_age, options));
  return 1 - std::exp(-by_age * factor(by_kind_, object.kind) * factor(by_place_, object.place) *
                      object.own.value());
}

void Habits::learn_handled(const Handled& object, Factor& own, double seconds, double handled,
                           const BeliefOptions& options) {
  const std::array<double, kAges> prior = prior_hazard(0, seconds, options);
  const double by_age = hazard(prior);
  if (by_age <= 0) return;
  // Each factor explains what those before it left; together they must not count the same evidence twice.
  const double by_kind = by_age * factor(by_kind_, object.kind);
  const double by_place = by_kind * factor(by_place_, object.place);
  const double all = by_place * own.value();
  const double exposed = 1 - handled * (1 - elapsed_share(all));
  for (size_t age = 0; age < kAges; ++age) {
    const double share = by_age_[age].value() * prior[age] / by_age;
    by_age_[age].count(handled * share, prior[age] * exposed);
  }
  if (!object.kind.empty()) by_kind_[object.kind].count(handled, by_age * exposed);
  if (!object.place.empty()) by_place_[object.place].count(handled, by_kind * exposed);
  own.count(handled, by_place * exposed);
}

double Habits::moved_to(const std::string& from, const std::string& to) const {
  double others = 0, there = 1, places = 0;
  for (const auto& [place, count] : put_down_) {
    if (place == from) continue;
    ++places;
    others += count + 1;
    if (place == to) there = count + 1;
  }
  const bool alone = others == 0 && from == to;  // no other place is known
  const double stays = stayed_on_place_ + (alone ? kPutDown : kPutDown / 2);
  const double leaves = went_elsewhere_ + (alone ? 0.0 : kPutDown / 2);
  const double all = stays + leaves + carried_off_ + kCarriedOff;
  // Beside a mean place, not beside all of them: what may have arrived from elsewhere competes with what is
  // new, and new things are expected on each place anew.
  return from == to ? stays / all
                    : leaves / all * (others > 0 ? std::min(1.0, places * there / others) : 1.0);
}

void Habits::learn_moved(const std::string& from, const std::string& to, double probability) {
  (from == to ? stayed_on_place_ : went_elsewhere_) += probability;
  if (!to.empty()) put_down_[to] += probability;
}

void Habits::learn_found_again(const std::string& from, const std::string& to, double probability) {
  carried_off_ = std::max(0.0, carried_off_ - probability);
  learn_moved(from, to, probability);
}

double Habits::returns(double age, const BeliefOptions& options) const {
  return std::min(0.9, options.reappear * returns_.at(age_of(age)).value());
}

void Habits::learn_returns(double age, double found, const BeliefOptions& options) {
  returns_.at(age_of(age)).count(found, options.reappear);
}

double Habits::false_share(const std::string& place, const BeliefOptions& options) const {
  const double expected = options.clutter / (options.clutter + options.appear);
  if (knows(place)) return std::min(0.9, expected * false_.value());
  // On a first look nearly everything is new.
  return expected * std::min(1.0, options.appear / arrivals(place, options));
}

void Habits::learn_false(double probability, const BeliefOptions& options) {
  false_.count(probability, options.clutter / (options.clutter + options.appear));
}

double Habits::arrivals(const std::string& place, const BeliefOptions& options) const {
  return options.appear * (put_down_.contains(place) ? later_look_ : first_look_).value();
}

void Habits::learn_arrivals(const std::string& place, double found, const BeliefOptions& options) {
  (put_down_.contains(place) ? later_look_ : first_look_).count(found, options.appear);
  if (!place.empty()) put_down_[place] += found;
}

}  // namespace loci::memory::belief
