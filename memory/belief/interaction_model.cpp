#include "memory/belief/interaction_model.h"

#include <algorithm>
#include <cmath>

namespace loci::memory::belief {
namespace {

using ByAge = std::array<double, InteractionModel::kAges>;

/// Seconds since an object was observed at which the next age begins.
constexpr std::array<double, InteractionModel::kAges - 1> kAgeBegins{300,      1200,      3600,
                                                                     4 * 3600, 24 * 3600, 7 * 24 * 3600};

/// Integrated prior rate of handling.
double cumulative_hazard(double seconds, const BeliefOptions& options) {
  const double soon = options.move_cap * (1 - std::exp(-seconds / options.move_time_s));
  return -std::log(1 - soon) +
         kParameters.hazard_tail * std::log1p(seconds / (kParameters.hazard_tail_time * options.move_time_s));
}

size_t age_index(double seconds) {
  const auto end = std::ranges::upper_bound(kAgeBegins, seconds);
  return static_cast<size_t>(end - kAgeBegins.begin());
}

/// Prior hazard between two ages, by age.
ByAge prior_hazard(double from_age, double to_age, const BeliefOptions& options) {
  ByAge parts{};
  double begin = std::max(0.0, from_age);
  if (to_age <= begin) return parts;
  double before = cumulative_hazard(begin, options);
  for (size_t age = 0; age < parts.size() && begin < to_age; ++age) {
    const double end = age < kAgeBegins.size() ? std::min(to_age, kAgeBegins[age]) : to_age;
    if (end <= begin) continue;
    const double now = cumulative_hazard(end, options);
    parts[age] = now - before;
    before = now;
    begin = end;
  }
  return parts;
}

/// Mean elapsed share of an interval at the time of an event in it, at a constant rate.
double elapsed_share(double hazard) {
  return hazard < 1e-3 ? 0.5 : 1 / hazard - 1 / std::expm1(hazard);
}

double factor(const std::map<std::string, RateFactor>& factors, const std::string& name) {
  const auto found = factors.find(name);
  return found == factors.end() ? 1.0 : found->second.value();
}

double prior_clutter_share(const BeliefOptions& options) {
  return options.clutter / (options.clutter + options.appear);
}

}  // namespace

double InteractionModel::hazard(const ByAge& prior) const {
  double sum = 0;
  for (size_t age = 0; age < kAges; ++age) sum += statistics_.by_age[age].value() * prior[age];
  return sum;
}

double InteractionModel::probability(const InteractionKey& object, double from_age, double to_age,
                                     const BeliefOptions& options) const {
  const double by_age = hazard(prior_hazard(from_age, to_age, options));
  return 1 - std::exp(-by_age * factor(statistics_.by_class, object.class_name) *
                      factor(statistics_.by_place, object.place) * object.own.value());
}

void InteractionModel::learn_interaction(const InteractionKey& object, RateFactor& own, double seconds,
                                         double handled, const BeliefOptions& options) {
  const ByAge prior = prior_hazard(0, seconds, options);
  const double by_age = hazard(prior);
  if (by_age <= 0) return;
  // Each factor explains what those before it leave; together they must not count the same evidence twice.
  const double by_class = by_age * factor(statistics_.by_class, object.class_name);
  const double by_place = by_class * factor(statistics_.by_place, object.place);
  const double all = by_place * own.value();
  const double exposed = 1 - handled * (1 - elapsed_share(all));
  for (size_t age = 0; age < kAges; ++age) {
    const double share = statistics_.by_age[age].value() * prior[age] / by_age;
    statistics_.by_age[age].count(handled * share, prior[age] * exposed);
  }
  if (!object.class_name.empty()) statistics_.by_class[object.class_name].count(handled, by_age * exposed);
  if (!object.place.empty()) statistics_.by_place[object.place].count(handled, by_class * exposed);
  own.count(handled, by_place * exposed);
}

double InteractionModel::moved_to(const std::string& from, const std::string& to) const {
  double others = 0, there = 1, places = 0;
  for (const auto& [place, count] : statistics_.put_down) {
    if (place == from) continue;
    ++places;
    others += count + 1;
    if (place == to) there = count + 1;
  }
  constexpr double kPutDown = kParameters.prior_put_down;
  const bool alone = others == 0 && from == to;  // no other place is known
  const double stays = statistics_.stayed_on_place + (alone ? kPutDown : kPutDown / 2);
  const double leaves = statistics_.went_elsewhere + (alone ? 0.0 : kPutDown / 2);
  const double all = stays + leaves + statistics_.carried_off + kParameters.prior_carried_off;
  // Relative to a mean place, not to all of them: arrivals from elsewhere compete with new objects, which are
  // expected on each place anew.
  return from == to ? stays / all
                    : leaves / all * (others > 0 ? std::min(1.0, places * there / others) : 1.0);
}

double InteractionModel::elsewhere() const {
  const double elsewhere = statistics_.went_elsewhere + kParameters.prior_put_down / 2;
  return elsewhere / (elsewhere + statistics_.carried_off + kParameters.prior_carried_off);
}

double InteractionModel::short_share() const {
  return (statistics_.short_moves + kParameters.prior_put_down / 2) /
         (statistics_.stayed_on_place + kParameters.prior_put_down);
}

void InteractionModel::learn_moved(const std::string& from, const std::string& to, double probability) {
  (from == to ? statistics_.stayed_on_place : statistics_.went_elsewhere) += probability;
  if (!to.empty()) statistics_.put_down[to] += probability;
}

void InteractionModel::learn_found_again(const std::string& from, const std::string& to, double probability) {
  statistics_.carried_off = std::max(0.0, statistics_.carried_off - probability);
  learn_moved(from, to, probability);
}

double InteractionModel::returns(double age, const BeliefOptions& options) const {
  return std::min(kParameters.max_probability,
                  options.reappear * statistics_.returns.at(age_index(age)).value());
}

void InteractionModel::learn_returns(double age, double found, const BeliefOptions& options) {
  statistics_.returns.at(age_index(age)).count(found, options.reappear);
}

double InteractionModel::clutter_share(const std::string& place, const BeliefOptions& options) const {
  const double expected = prior_clutter_share(options);
  if (knows(place)) return std::min(kParameters.max_probability, expected * statistics_.clutter.value());
  // When a place is first observed nearly everything is new.
  return expected * std::min(1.0, options.appear / arrivals(place, options));
}

void InteractionModel::learn_clutter(double probability, const BeliefOptions& options) {
  statistics_.clutter.count(probability, prior_clutter_share(options));
}

double InteractionModel::arrivals(const std::string& place, const BeliefOptions& options) const {
  return options.appear * (knows(place) ? statistics_.later_view : statistics_.first_view).value();
}

void InteractionModel::learn_arrivals(const std::string& place, double found, const BeliefOptions& options) {
  (knows(place) ? statistics_.later_view : statistics_.first_view).count(found, options.appear);
  if (!place.empty()) statistics_.put_down[place] += found;
}

void InteractionModel::import_class(const std::string& class_name, const RateFactor& elsewhere) {
  statistics_.by_class[class_name].count(elsewhere.found, elsewhere.expected);
}

void InteractionModel::retain_classes(const std::set<std::string>& class_names) {
  std::erase_if(statistics_.by_class,
                [&](const auto& of_class) { return !class_names.contains(of_class.first); });
}

}  // namespace loci::memory::belief
