#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <utility>

#include "memory/identity/solution.h"
#include "tests/memory/identity/random_problem.h"

namespace loci::memory {
namespace {

using testing_support::random_problem;

IdentityOptions exact() {
  IdentityOptions options;
  options.gate = 0;
  return options;
}

PairTable matched(const IdentitySolution& solution) {
  return solution.stay + solution.move + solution.newview;
}

TEST(Identity, ProbabilitiesOfRowsAndColumnsSumToOne) {
  Random random(1);
  IdentityOptions options = exact();
  options.priors.clutter = -2;
  options.priors.missed = -1;
  const IdentitySolution solution = solve(testing_support::random_problem(7, 9, random), options);
  for (size_t o = 0; o < 7; ++o)
    EXPECT_NEAR(matched(solution).row(static_cast<Eigen::Index>(o)).sum() + solution.disappear[o] +
                    solution.missed[o] + solution.hidden[o],
                1, 1e-12);
  for (size_t k = 0; k < 9; ++k)
    EXPECT_NEAR(
        matched(solution).col(static_cast<Eigen::Index>(k)).sum() + solution.appear[k] + solution.clutter[k],
        1, 1e-12);
}

TEST(Identity, TransposingTheProblemTransposesTheAnswer) {
  Random random(2);
  const IdentityProblem problem = testing_support::random_problem(5, 8, random, false);
  IdentityProblem turned;
  turned.old_count = 8;
  turned.new_count = 5;
  turned.out_of_view.assign(8, 0.0);
  turned.similar.assign(8, std::vector<std::optional<double>>(5));
  turned.proximity = turned.similar;
  for (size_t o = 0; o < 5; ++o)
    for (size_t k = 0; k < 8; ++k) {
      turned.similar[k][o] = problem.similar[o][k];
      turned.proximity[k][o] = problem.proximity[o][k];
    }
  const IdentitySolution a = solve(problem, exact()), b = solve(turned, exact());
  EXPECT_LT((matched(a) - matched(b).transpose()).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_NEAR(a.log_z, b.log_z, 1e-12);
  for (size_t k = 0; k < 8; ++k) EXPECT_NEAR(a.appear[k], b.disappear[k], 1e-12);
}

TEST(Identity, PermutingTheObjectsPermutesTheAnswer) {
  Random random(3);
  const IdentityProblem problem = testing_support::random_problem(6, 6, random);
  const std::vector<size_t> order{3, 0, 5, 1, 4, 2};
  IdentityProblem permuted = problem;
  for (size_t o = 0; o < 6; ++o) {
    permuted.similar[o] = problem.similar[order[o]];
    permuted.proximity[o] = problem.proximity[order[o]];
    permuted.out_of_view[o] = problem.out_of_view[order[o]];
  }
  const IdentitySolution a = solve(problem, exact()), b = solve(permuted, exact());
  for (size_t o = 0; o < 6; ++o) {
    const auto here = static_cast<Eigen::Index>(o), there = static_cast<Eigen::Index>(order[o]);
    EXPECT_LT((matched(b).row(here) - matched(a).row(there)).cwiseAbs().maxCoeff(), 1e-12);
    EXPECT_NEAR(b.hidden[o], a.hidden[order[o]], 1e-12);
  }
}

TEST(Identity, ProximityOfAnObjectThatIsCertainlyOutOfViewHasNoEffect) {
  Random random(4);
  IdentityProblem problem = testing_support::random_problem(4, 4, random);
  problem.out_of_view[2] = 1;
  const IdentitySolution before = solve(problem, exact());
  for (auto& p : problem.proximity[2]) p = random.uniform();
  const IdentitySolution after = solve(problem, exact());
  EXPECT_LT((matched(before) - matched(after)).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_EQ(after.disappear[2], 0);
  EXPECT_NEAR(after.out_of_view_posterior[2], 1, 1e-12);
}

TEST(Identity, RaisingAnEntryRaisesTheProbabilityOfItsPair) {
  Random random(5);
  for (int repeat = 0; repeat < 20; ++repeat) {
    IdentityProblem problem = testing_support::random_problem(5, 4, random);
    const double before = matched(solve(problem, exact()))(1, 2);
    problem.similar[1][2] = *problem.similar[1][2] + 0.5 * (1 - *problem.similar[1][2]);
    EXPECT_GE(matched(solve(problem, exact()))(1, 2), before);
  }
}

TEST(Identity, AnObjectWithoutAnyEvidenceChangesNothingElse) {
  Random random(6);
  IdentityProblem problem = testing_support::random_problem(4, 5, random);
  const IdentitySolution before = solve(problem, exact());
  problem.old_count = 5;
  problem.similar.emplace_back(5, 0.0);
  problem.proximity.emplace_back(5, 0.0);
  problem.out_of_view.push_back(0.25);
  const IdentitySolution after = solve(problem, exact());
  EXPECT_LT((matched(after).topRows(4) - matched(before)).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_NEAR(after.hidden[4], 0.25, 1e-12);
  EXPECT_NEAR(after.disappear[4], 0.75, 1e-12);
}

TEST(Identity, ManyObjectsThatDependOnFewOthersAreSolvedExactly) {
  // Observation k may be object k or k + 1, all odds 1: a path of 80 edges, whose matchings are counted by
  // the Fibonacci numbers.
  constexpr Eigen::Index kCount = 40;
  LogOddsProblem problem;
  problem.log_similar = PairTable::Constant(kCount + 1, kCount, kNever);
  for (Eigen::Index k = 0; k < kCount; ++k) problem.log_similar(k, k) = problem.log_similar(k + 1, k) = 0;
  problem.log_proximity = PairTable::Constant(kCount + 1, kCount, kNever);
  problem.out_of_view.assign(kCount + 1, 0.0);
  const IdentitySolution solution = solve(problem, exact());
  double matchings = 1, before = 1;
  for (int edge = 0; edge < 2 * kCount; ++edge) before = std::exchange(matchings, matchings + before);
  EXPECT_NEAR(solution.log_z, std::log(matchings), 1e-9);
  EXPECT_EQ(solution.gate_bound, 0);
  for (Eigen::Index k = 0; k < kCount; ++k)
    EXPECT_NEAR(matched(solution).col(k).sum() + solution.appear[static_cast<size_t>(k)], 1, 1e-12);
}

TEST(Identity, OddsOfManyObjectsMayBeLarge) {
  constexpr Eigen::Index kCount = 60;
  LogOddsProblem problem;
  problem.log_similar = PairTable::Constant(kCount, kCount, kNever);
  for (Eigen::Index k = 0; k < kCount; ++k) problem.log_similar(k, k) = 25;
  for (Eigen::Index k = 1; k < kCount; ++k) problem.log_similar(k, k - 1) = 0;
  problem.log_proximity = PairTable::Constant(kCount, kCount, kNever);
  problem.out_of_view.assign(kCount, 0.0);
  const IdentitySolution solution = solve(problem, exact());
  EXPECT_NEAR(solution.log_z, 25 * kCount, 1e-6);
  for (Eigen::Index k = 0; k < kCount; ++k) EXPECT_NEAR(solution.none(k, k), 0, 1e-9);
}

TEST(Identity, SplittingIntoComponentsDoesNotChangeTheAnswer) {
  Random random(7);
  const IdentityProblem a = testing_support::random_problem(4, 5, random),
                        b = testing_support::random_problem(5, 3, random);
  IdentityProblem both;
  both.old_count = 9;
  both.new_count = 8;
  both.similar.assign(9, std::vector<std::optional<double>>(8, 0.0));
  both.proximity = both.similar;
  for (size_t o = 0; o < 9; ++o)
    for (size_t k = 0; k < 8; ++k) {
      if (o < 4 && k < 5) both.similar[o][k] = a.similar[o][k], both.proximity[o][k] = a.proximity[o][k];
      if (o >= 4 && k >= 5)
        both.similar[o][k] = b.similar[o - 4][k - 5], both.proximity[o][k] = b.proximity[o - 4][k - 5];
    }
  both.out_of_view = a.out_of_view;
  both.out_of_view.insert(both.out_of_view.end(), b.out_of_view.begin(), b.out_of_view.end());
  const IdentitySolution whole = solve(both, exact()), first = solve(a, exact()), second = solve(b, exact());
  EXPECT_NEAR(whole.log_z, first.log_z + second.log_z, 1e-12);
  EXPECT_LT((matched(whole).topLeftCorner(4, 5) - matched(first)).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_LT((matched(whole).bottomRightCorner(5, 3) - matched(second)).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(Identity, GatingStaysWithinItsBound) {
  Random random(8);
  for (int repeat = 0; repeat < 10; ++repeat) {
    const IdentityProblem problem = testing_support::random_problem(7, 7, random);
    IdentityOptions gated = exact();
    gated.gate = 0.2;
    const IdentitySolution a = solve(problem, exact()), b = solve(problem, gated);
    EXPECT_EQ(a.gate_bound, 0);
    EXPECT_LE(b.gate_bound, 0.2);
    EXPECT_LE((matched(a) - matched(b)).cwiseAbs().maxCoeff(), b.gate_bound);
    EXPECT_LE(a.log_z - b.log_z, -std::log1p(-b.gate_bound) + 1e-12);
  }
}

TEST(Identity, AProblemThatIsTooLargeIsSolvedWithAReportedBound) {
  Random random(9);
  IdentityProblem problem = testing_support::random_problem(40, 40, random, false);
  for (size_t o = 0; o < 40; ++o)
    for (size_t k = 0; k < 40; ++k) {
      const bool together = o / 8 == k / 8;
      if (!together) problem.similar[o][k] = 1e-8;
      if (!together) problem.proximity[o][k] = 0;
    }
  const IdentitySolution solution = solve(problem, exact());
  EXPECT_GT(solution.gate_bound, 0);
  EXPECT_LT(solution.gate_bound, 1e-4);
}

TEST(Identity, LongProblemsKeepOnlyCheckpoints) {
  // One side is so long that not all layers are kept; the answer must be that of the transposed problem.
  IdentityProblem problem;
  problem.old_count = 16;
  problem.new_count = 600;
  Random random(10);
  for (size_t o = 0; o < 16; ++o) {
    problem.similar.emplace_back();
    for (size_t k = 0; k < 600; ++k) problem.similar[o].emplace_back(0.02 * random.uniform());
  }
  problem.proximity = problem.similar;
  problem.out_of_view.assign(16, 0.0);
  const IdentitySolution solution = solve(problem, exact());
  for (size_t o = 0; o < 16; ++o)
    EXPECT_NEAR(matched(solution).row(static_cast<Eigen::Index>(o)).sum() + solution.disappear[o], 1, 1e-11);
}

TEST(Identity, ClampsLogOddsToTheRangeOfADouble) {
  LogOddsProblem problem;
  problem.log_similar = PairTable::Constant(3, 3, -1e6);
  problem.log_similar.diagonal().setConstant(1e6);
  problem.log_proximity = problem.log_similar;
  problem.out_of_view = {0, 0, 0};
  const IdentitySolution solution = solve(problem, exact());
  for (Eigen::Index i = 0; i < 3; ++i) EXPECT_NEAR(solution.stay(i, i), 1, 1e-12);
  EXPECT_TRUE(std::isfinite(solution.log_z));
}

TEST(Identity, DecisionsNamePartnerAndExplanation) {
  IdentityProblem problem;
  problem.old_count = 2;
  problem.new_count = 2;
  problem.similar = {{0.95, 0.0}, {0.0, 0.0}};
  problem.proximity = {{0.95, 0.0}, {0.0, 0.0}};
  problem.out_of_view = {0, 0.9};
  const IdentitySolution solution = solve(problem, exact());
  const IdentityDecision seen = decide_observation(solution, 0), fresh = decide_observation(solution, 1);
  EXPECT_EQ(seen.partner, std::optional<size_t>(0));
  EXPECT_EQ(seen.explanation, Explanation::stay);
  EXPECT_FALSE(fresh.partner.has_value());
  EXPECT_EQ(fresh.explanation, Explanation::appear);
  EXPECT_EQ(decide_object(solution, 1).explanation, Explanation::hidden);
  EXPECT_EQ(solution.map.pairs, (std::vector<std::pair<size_t, size_t>>{{0, 0}}));
}

TEST(Identity, RefusesBadInputAndSaysWhere) {
  const auto message = [](IdentityProblem problem, IdentityOptions options = {}) -> std::string {
    try {
      solve(problem, options);
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  };
  Random random(1);
  IdentityProblem problem = testing_support::random_problem(2, 2, random);
  IdentityProblem bad = problem;
  bad.similar[1][0] = std::nan("");
  EXPECT_THAT(message(bad), testing::HasSubstr("similar[1][0]: invalid_value"));
  bad = problem;
  bad.proximity[0][1] = 1.01;
  EXPECT_THAT(message(bad), testing::HasSubstr("proximity[0][1]: invalid_value"));
  bad = problem;
  bad.out_of_view.pop_back();
  EXPECT_THAT(message(bad), testing::HasSubstr("out_of_view: invalid_shape"));
  bad = problem;
  bad.similar.pop_back();
  EXPECT_THAT(message(bad), testing::HasSubstr("similar: invalid_shape"));
  IdentityOptions options;
  options.floor = 2;
  EXPECT_THAT(message(problem, options), testing::HasSubstr("params.floor: invalid_value"));
}

}  // namespace
}  // namespace loci::memory
