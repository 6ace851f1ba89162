// Who is who: the decision and the distributions.

#include <algorithm>
#include <map>

#include "memory/belief/step.h"

namespace loci::memory::belief {
namespace {

constexpr double kMinShare = 0.001;
constexpr double kMinAlternative = 0.02;

std::vector<Alternative> alternatives_of(const std::map<int64_t, double>& keys, int64_t itself, double sum) {
  std::vector<Alternative> list;
  for (const auto& [key, weight] : keys)
    if (key != itself && weight / sum >= kMinAlternative) list.push_back({key, weight / sum});
  std::stable_sort(list.begin(), list.end(),
                   [](const Alternative& a, const Alternative& b) { return a.probability > b.probability; });
  return list;
}

}  // namespace

void Step::pair_up() {
  partner_of_object_.resize(state_.objects.size());
  partner_of_observation_.resize(scene_.observations.size());
  for (const auto& [o, k] : solution_.map.pairs) {
    partner_of_object_[o] = k;
    partner_of_observation_[k] = o;
  }
  if (snapshot_) return;
  for (size_t k = 0; k < partner_of_observation_.size(); ++k) prefer_known(k);
}

void Step::prefer_known(size_t k) {
  const std::optional<size_t> now = partner_of_observation_[k];
  if (now && (state_.objects[*now].status != Status::tentative || state_.objects[*now].leftover_of != 0))
    return;
  std::optional<size_t> known;
  double most = 0.4;
  for (size_t o = 0; o < state_.objects.size(); ++o) {
    if (state_.objects[o].status != Status::present || partner_of_object_[o]) continue;
    const auto row = static_cast<Eigen::Index>(o), column = static_cast<Eigen::Index>(k);
    const AxisBox& seen = scene_.observations[k].box;
    const double covered = covered_share(expected_[o], seen);
    const double color = update_.evidence.log_similar(row, column) -
                         options_.appearance_weight * update_.evidence.log_size(row, column);
    if (covered <= most || color < -2.5 || seen.volume() > 3 * expected_[o].box.volume()) continue;
    most = covered;
    known = o;
  }
  if (!known) return;
  if (now) {
    partner_of_object_[*now].reset();
    state_.objects[*now].exists_log_odds = -100;  // it was a double
  }
  partner_of_object_[*known] = k;
  partner_of_observation_[k] = known;
}

Explanation Step::explanation_of_pair(size_t o, size_t k) const {
  const auto row = static_cast<Eigen::Index>(o), column = static_cast<Eigen::Index>(k);
  const double stay = weights_.stay(row, column), move = weights_.move(row, column),
               newview = weights_.newview(row, column);
  if (stay >= move && stay >= newview) return Explanation::stay;
  if (!snapshot_ && covered_share(expected_[o], scene_.observations[k].box) > 0.4) return Explanation::stay;
  return move >= newview ? Explanation::move : Explanation::newview;
}

void Step::report_distributions() {
  for (size_t k = 0; k < scene_.observations.size(); ++k) {
    ObservationOutcome outcome;
    const auto column = static_cast<Eigen::Index>(k);
    for (size_t o = 0; o < state_.objects.size(); ++o) {
      const auto row = static_cast<Eigen::Index>(o);
      const Share share{state_.objects[o].key, state_.objects[o].id, solution_.stay(row, column),
                        solution_.move(row, column), solution_.newview(row, column)};
      if (partner_of_observation_[k] == o) {
        outcome.key = share.key;
        outcome.explanation = explanation_of_pair(o, k);
        outcome.probability = share.probability();
      }
      if (share.probability() >= kMinShare || partner_of_observation_[k] == o)
        outcome.shares.push_back(share);
    }
    std::stable_sort(outcome.shares.begin(), outcome.shares.end(),
                     [](const Share& a, const Share& b) { return a.probability() > b.probability(); });
    outcome.appear = solution_.appear[k];
    outcome.clutter = solution_.clutter[k];
    update_.observations.push_back(std::move(outcome));
  }
  for (size_t o = 0; o < state_.objects.size(); ++o) {
    ObjectOutcome outcome;
    outcome.key = state_.objects[o].key;
    outcome.visibility = expected_[o].seen.visibility;
    outcome.disappear = solution_.disappear[o];
    outcome.missed = solution_.missed[o];
    outcome.hidden = solution_.hidden[o];
    outcome.matched = std::max(0.0, 1 - outcome.disappear - outcome.missed - outcome.hidden);
    update_.objects.push_back(outcome);
  }
}

std::vector<std::vector<Alternative>> Step::mixed_alternatives() const {
  std::vector<std::vector<Alternative>> mixed;
  for (size_t o = 0; o < state_.objects.size(); ++o) {
    if (state_.objects[o].id == 0) {
      mixed.emplace_back();
      continue;
    }
    std::map<int64_t, double> keys;
    double sum = 0;
    const auto add = [&](size_t other, double weight) {
      if (weight <= 0 || state_.objects[other].id == 0) return;
      sum += weight;
      keys[state_.objects[other].key] += weight * state_.objects[other].probability_itself();
      for (const Alternative& alternative : state_.objects[other].alternatives)
        keys[alternative.key] += weight * alternative.probability;
    };
    if (const std::optional<size_t> seen_as = partner_of_object_[o]) {
      for (size_t other = 0; other < state_.objects.size(); ++other) add(other, probability(other, *seen_as));
    } else {
      double matched = 0;
      for (size_t k = 0; k < scene_.observations.size(); ++k) matched += probability(o, k);
      if (matched < kMinAlternative) {
        mixed.push_back(state_.objects[o].alternatives);
        continue;
      }
      for (size_t k = 0; k < scene_.observations.size(); ++k)
        if (partner_of_observation_[k]) add(*partner_of_observation_[k], probability(o, k));
      add(o, std::max(0.0, 1 - matched));
    }
    mixed.push_back(alternatives_of(keys, state_.objects[o].key, sum));
  }
  return mixed;
}

double Step::probability(size_t o, size_t k) const {
  const auto row = static_cast<Eigen::Index>(o), column = static_cast<Eigen::Index>(k);
  return solution_.stay(row, column) + solution_.move(row, column) + solution_.newview(row, column);
}

}  // namespace loci::memory::belief
