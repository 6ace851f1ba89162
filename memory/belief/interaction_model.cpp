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

double InteractionModel::hazard_of_uses(const InteractionKey& object) const {
  return object.uses * kParameters.handled_per_use * statistics_.by_use.value();
}

double InteractionModel::probability(const InteractionKey& object, double from_age, double to_age,
                                     const BeliefOptions& options) const {
  const double by_age = hazard(prior_hazard(from_age, to_age, options));
  return 1 - std::exp(-by_age * factor(statistics_.by_class, object.class_name) *
                          factor(statistics_.by_place, object.place) * object.own.value() -
                      hazard_of_uses(object));
}

void InteractionModel::learn_interaction(const InteractionKey& object, RateFactor& own, double from_age,
                                         double to_age, double handled, double weight,
                                         const BeliefOptions& options) {
  const ByAge prior = prior_hazard(from_age, to_age, options);
  const double by_age = hazard(prior);
  if (by_age <= 0) return;
  // Each factor explains what those before it leave; together they must not count the same evidence twice.
  const double by_class = by_age * factor(statistics_.by_class, object.class_name);
  const double by_place = by_class * factor(statistics_.by_place, object.place);
  const double in_time = by_place * own.value(), by_use = hazard_of_uses(object), all = in_time + by_use;
  const double exposed = weight * (1 - handled * (1 - elapsed_share(all)));
  const double found = weight * handled * in_time / all;
  statistics_.by_use.count(weight * handled * by_use / all,
                           object.uses * kParameters.handled_per_use * exposed);
  for (size_t age = 0; age < kAges; ++age) {
    const double share = statistics_.by_age[age].value() * prior[age] / by_age;
    statistics_.by_age[age].count(found * share, prior[age] * exposed);
  }
  if (!object.class_name.empty()) statistics_.by_class[object.class_name].count(found, by_age * exposed);
  if (!object.place.empty()) statistics_.by_place[object.place].count(found, by_class * exposed);
  own.count(found, by_place * exposed);
}

double InteractionModel::outcome_share(const RateFactor& outcome, bool alone) const {
  constexpr double kPutDown = kParameters.prior_put_down;
  const double within = statistics_.within.value() * (alone ? kPutDown : kPutDown / 2);
  const double elsewhere = statistics_.elsewhere.value() * (alone ? 0.0 : kPutDown / 2);
  const double off = statistics_.off.value() * kParameters.prior_carried_off;
  const double share = &outcome == &statistics_.within      ? within
                       : &outcome == &statistics_.elsewhere ? elsewhere
                                                            : off;
  return share / (within + elsewhere + off);
}

double InteractionModel::moved_to(const std::string& from, const std::string& to) const {
  return destination_share(from, to, put_down_beside(from));
}

std::vector<double> InteractionModel::destinations(const std::string& from,
                                                   const PlaceHistories& places) const {
  const double beside = put_down_beside(from);
  std::vector<double> shares;
  for (const auto& [place, history] : places) shares.push_back(destination_share(from, place, beside));
  return shares;
}

double InteractionModel::put_down_beside(const std::string& from) const {
  double beside = 0;
  for (const auto& [place, count] : statistics_.put_down)
    if (place != from) beside += count + 1;
  return beside;
}

double InteractionModel::destination_share(const std::string& from, const std::string& to,
                                           double beside) const {
  if (from == to) return outcome_share(statistics_.within, beside == 0);
  const auto found = statistics_.put_down.find(to);
  const double there = found == statistics_.put_down.end() ? 1 : found->second + 1;
  return outcome_share(statistics_.elsewhere, false) * (beside > 0 ? std::min(1.0, there / beside) : 1.0);
}

double InteractionModel::elsewhere() const {
  const double elsewhere = statistics_.elsewhere.value() * kParameters.prior_put_down / 2;
  return elsewhere / (elsewhere + statistics_.off.value() * kParameters.prior_carried_off);
}

double InteractionModel::short_share() const {
  return (statistics_.short_moves + kParameters.prior_put_down / 2) /
         (statistics_.moves_within + kParameters.prior_put_down);
}

void InteractionModel::learn_moved(const std::string& from, const std::string& to, double found,
                                   double expected) {
  learn(from == to ? statistics_.within : statistics_.elsewhere, found, expected);
  if (!to.empty()) statistics_.put_down[to] += found;
}

void InteractionModel::learn_short_move(double moved, double short_one) {
  statistics_.moves_within += moved;
  statistics_.short_moves += short_one;
}

double InteractionModel::returns(double age, const BeliefOptions& options) const {
  return std::min(kParameters.max_probability,
                  options.reappear * statistics_.returns.at(age_index(age)).value());
}

void InteractionModel::learn_returns(double age, double found, const BeliefOptions& options) {
  statistics_.returns.at(age_index(age)).count(found, options.reappear);
}

double InteractionModel::clutter_share(const std::string& place, double arrivals,
                                       const BeliefOptions& options) const {
  const double expected = prior_clutter_share(options);
  if (knows(place)) return std::min(kParameters.max_probability, expected * statistics_.clutter.value());
  // When a place is first observed nearly everything is new.
  return expected * std::min(1.0, options.appear / arrivals);
}

void InteractionModel::learn_clutter(double probability, const BeliefOptions& options) {
  statistics_.clutter.count(probability, prior_clutter_share(options));
}

double InteractionModel::relative_gap(double unseen_seconds) const {
  return statistics_.unseen_seconds > 0 ? unseen_seconds * statistics_.views / statistics_.unseen_seconds
                                        : 1.0;
}

double InteractionModel::arrivals(const PlaceView& place, const BeliefOptions& options) const {
  return options.appear * (place.never_seen * statistics_.first_view.value() +
                           relative_gap(place.unseen_seconds) * statistics_.later_view.value());
}

void InteractionModel::learn_arrivals(const PlaceView& place, double found, const BeliefOptions& options) {
  const bool known = knows(place.name);
  const double never_seen = known ? place.never_seen : 1.0;
  const double gap = known ? relative_gap(place.unseen_seconds) : 0.0;
  const double first = never_seen * statistics_.first_view.value(),
               later = gap * statistics_.later_view.value();
  const double share_first = first + later > 0 ? first / (first + later) : 0.0;
  statistics_.first_view.count(found * share_first, options.appear * never_seen * place.share);
  statistics_.later_view.count(found * (1 - share_first), options.appear * gap * place.share);
  if (known) {
    statistics_.views += place.share;
    statistics_.unseen_seconds += place.share * place.unseen_seconds;
  }
  if (!place.name.empty()) statistics_.put_down[place.name] += found;
}

void InteractionModel::import_class(const std::string& class_name, const RateFactor& elsewhere) {
  statistics_.by_class[class_name].count(elsewhere.found, elsewhere.expected);
}

void InteractionModel::retain_classes(const std::set<std::string>& class_names) {
  std::erase_if(statistics_.by_class,
                [&](const auto& of_class) { return !class_names.contains(of_class.first); });
}

}  // namespace loci::memory::belief
