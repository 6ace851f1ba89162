// The solver against literal enumeration of all ground atoms (formulas 1 to 9), and of all matchings.

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "memory/identity/solution.h"
#include "tests/memory/identity/random_problem.h"

namespace loci::memory {
namespace {

using testing_support::random_problem;

struct Enumerated {
  double evidence = 0;
  PairTable stay, move, newview;
  std::vector<double> appear, disappear, hidden;
};

/// Sums over all assignments of S, P and V; a world counts only when every formula holds in it.
Enumerated enumerate_worlds(const IdentityProblem& problem) {
  const size_t m = problem.old_count, n = problem.new_count, pairs = m * n;
  Enumerated sum;
  sum.stay = sum.move = sum.newview =
      PairTable::Zero(static_cast<Eigen::Index>(m), static_cast<Eigen::Index>(n));
  sum.appear.assign(n, 0);
  sum.disappear.assign(m, 0);
  sum.hidden.assign(m, 0);
  for (size_t world = 0; world < size_t{1} << (2 * pairs + m); ++world) {
    const auto similar = [&](size_t o, size_t k) { return (world >> (o * n + k) & 1) != 0; };
    const auto proximate = [&](size_t o, size_t k) { return (world >> (pairs + o * n + k) & 1) != 0; };
    const auto hidden = [&](size_t o) { return (world >> (2 * pairs + o) & 1) != 0; };
    double weight = 1;
    bool valid = true;
    std::vector<int> row(m, 0), column(n, 0);
    for (size_t o = 0; o < m; ++o) {
      weight *= hidden(o) ? problem.out_of_view[o] : 1 - problem.out_of_view[o];
      for (size_t k = 0; k < n; ++k) {
        weight *= similar(o, k) ? *problem.similar[o][k] : 1 - *problem.similar[o][k];
        weight *= proximate(o, k) ? *problem.proximity[o][k] : 1 - *problem.proximity[o][k];
        const bool same = similar(o, k) || proximate(o, k);
        row[o] += same;
        column[k] += same;
        valid = valid && row[o] <= 1 && column[k] <= 1 && !(hidden(o) && proximate(o, k));
      }
    }
    if (!valid || weight == 0) continue;
    sum.evidence += weight;
    for (size_t o = 0; o < m; ++o) {
      for (size_t k = 0; k < n; ++k) {
        const auto i = static_cast<Eigen::Index>(o), j = static_cast<Eigen::Index>(k);
        if (similar(o, k) && proximate(o, k)) sum.stay(i, j) += weight;
        if (similar(o, k) && !proximate(o, k)) sum.move(i, j) += weight;
        if (!similar(o, k) && proximate(o, k)) sum.newview(i, j) += weight;
      }
      if (row[o] == 0) (hidden(o) ? sum.hidden : sum.disappear)[o] += weight;
    }
    for (size_t k = 0; k < n; ++k)
      if (column[k] == 0) sum.appear[k] += weight;
  }
  return sum;
}

TEST(IdentityEnumeration, AgreesWithTheSumOverAllWorlds) {
  Random random(11);
  for (int repeat = 0; repeat < 30; ++repeat) {
    const size_t m = 1 + random.index(3), n = 1 + random.index(m == 3 ? 2 : 3);
    const IdentityProblem problem = testing_support::random_problem(m, n, random);
    IdentityOptions options;
    options.gate = 0;
    const IdentitySolution solution = solve(problem, options);
    const Enumerated worlds = enumerate_worlds(problem);
    EXPECT_NEAR(solution.log_evidence, std::log(worlds.evidence), 1e-9);
    EXPECT_LT((solution.stay - worlds.stay / worlds.evidence).cwiseAbs().maxCoeff(), 1e-9);
    EXPECT_LT((solution.move - worlds.move / worlds.evidence).cwiseAbs().maxCoeff(), 1e-9);
    EXPECT_LT((solution.newview - worlds.newview / worlds.evidence).cwiseAbs().maxCoeff(), 1e-9);
    for (size_t k = 0; k < n; ++k) EXPECT_NEAR(solution.appear[k], worlds.appear[k] / worlds.evidence, 1e-9);
    for (size_t o = 0; o < m; ++o) {
      EXPECT_NEAR(solution.disappear[o], worlds.disappear[o] / worlds.evidence, 1e-9);
      EXPECT_NEAR(solution.hidden[o], worlds.hidden[o] / worlds.evidence, 1e-9);
    }
  }
}

using Pairs = std::vector<std::pair<size_t, size_t>>;

void enumerate_matchings(const PairTable& total, const std::vector<double>& row,
                         const std::vector<double>& column, size_t o, Pairs& pairs, std::vector<bool>& taken,
                         double weight, std::map<Pairs, double>& all) {
  if (o == row.size()) {
    for (size_t k = 0; k < column.size(); ++k) weight += taken[k] ? 0 : column[k];
    if (weight != kNever) all[pairs] = weight;
    return;
  }
  enumerate_matchings(total, row, column, o + 1, pairs, taken, weight + row[o], all);
  for (size_t k = 0; k < column.size(); ++k) {
    const double pair = total(static_cast<Eigen::Index>(o), static_cast<Eigen::Index>(k));
    if (taken[k] || pair == kNever) continue;
    taken[k] = true;
    pairs.emplace_back(o, k);
    enumerate_matchings(total, row, column, o + 1, pairs, taken, weight + pair, all);
    pairs.pop_back();
    taken[k] = false;
  }
}

std::map<Pairs, double> all_matchings(const IdentityWeights& weights) {
  std::vector<double> row, column;
  for (size_t o = 0; o < weights.old_count(); ++o)
    row.push_back(log_add(log_add(weights.disappear[o], weights.missed[o]), weights.hidden[o]));
  for (size_t k = 0; k < weights.new_count(); ++k)
    column.push_back(log_add(weights.appear[k], weights.clutter[k]));
  std::map<Pairs, double> all;
  Pairs pairs;
  std::vector<bool> taken(column.size(), false);
  enumerate_matchings(weights.total, row, column, 0, pairs, taken, 0, all);
  return all;
}

void expect_agreement(const IdentityWeights& weights, const IdentityOptions& options) {
  const IdentitySolution solution = solve(weights, options);
  const std::map<Pairs, double> all = all_matchings(weights);
  double log_z = kNever;
  for (const auto& [pairs, weight] : all) log_z = log_add(log_z, weight);
  EXPECT_NEAR(solution.log_z, log_z, 1e-10);
  PairTable matched = PairTable::Zero(weights.total.rows(), weights.total.cols());
  std::vector<double> ranked;
  for (const auto& [pairs, weight] : all) {
    ranked.push_back(weight);
    for (const auto& [o, k] : pairs)
      matched(static_cast<Eigen::Index>(o), static_cast<Eigen::Index>(k)) += std::exp(weight - log_z);
  }
  const PairTable found = solution.stay + solution.move + solution.newview;
  EXPECT_LT((found - matched).cwiseAbs().maxCoeff(), 1e-10);
  std::sort(ranked.rbegin(), ranked.rend());
  ASSERT_EQ(solution.best.size(), std::min<size_t>(ranked.size(), static_cast<size_t>(options.best)));
  for (size_t i = 0; i < solution.best.size(); ++i) {
    EXPECT_NEAR(solution.best[i].log_weight, ranked[i], 1e-9);
    EXPECT_NEAR(all.at(solution.best[i].pairs), solution.best[i].log_weight, 1e-9);
  }
}

TEST(IdentityEnumeration, AgreesWithTheSumOverAllMatchingsAndTheirRanking) {
  Random random(12);
  for (int repeat = 0; repeat < 60; ++repeat) {
    IdentityOptions options;
    options.gate = 0;
    options.best = 40;
    options.priors = {random.normal(), random.normal(), random.normal(), random.normal(),
                      random.normal(), random.normal(), random.normal(), random.normal()};
    expect_agreement(
        weights_of(testing_support::random_problem(1 + random.index(5), 1 + random.index(5), random),
                   options),
        options);
  }
}

TEST(IdentityEnumeration, HandlesObservationsAndObjectsThatMustBeMatched) {
  Random random(13);
  int solved = 0;
  for (int repeat = 0; repeat < 60; ++repeat) {
    IdentityOptions options;
    options.gate = 0;
    options.best = 20;
    if (repeat % 2 == 0)
      options.priors.appear = kNever;
    else
      options.priors.disappear = options.priors.hidden = kNever;
    const IdentityWeights weights = weights_of(testing_support::random_problem(3, 3, random), options);
    if (all_matchings(weights).empty()) {
      EXPECT_THROW(solve(weights, options), Error);
      continue;
    }
    expect_agreement(weights, options);
    ++solved;
  }
  EXPECT_GT(solved, 10);
}

TEST(IdentityEnumeration, AgreesForLogOddsWithPriorsOfTheirOwn) {
  Random random(14);
  for (int repeat = 0; repeat < 20; ++repeat) {
    LogOddsProblem problem;
    problem.log_similar = PairTable::NullaryExpr(4, 3, [&] { return random.normal(6); });
    problem.log_proximity = PairTable::NullaryExpr(4, 3, [&] { return random.normal(6); });
    problem.move_prior = PairTable::NullaryExpr(4, 3, [&] { return random.normal(2); });
    problem.out_of_view = {0, 1, 0.3, 0.9};
    problem.appear_prior = {0.5, -1, 2};
    problem.hidden_prior = {0, -2, 0.1, 1};
    IdentityOptions options;
    options.gate = 0;
    options.best = 30;
    expect_agreement(weights_of(problem, options), options);
  }
}

}  // namespace
}  // namespace loci::memory
