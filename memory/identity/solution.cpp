#include "memory/identity/solution.h"

#include <algorithm>
#include <cmath>

#include "memory/identity/marginals.h"
#include "memory/identity/matchings.h"

namespace loci::memory {
namespace {

/// Shares of the weight of staying unmatched.
double share(double log_part, double log_total) {
  return log_part == kNever ? 0 : std::exp(log_part - log_total);
}

IdentityComponents components_of(const IdentityWeights& weights, const IdentityOptions& options) {
  std::vector<double> old_weight(weights.old_count()), new_weight(weights.new_count());
  for (size_t o = 0; o < old_weight.size(); ++o)
    old_weight[o] = log_add(log_add(weights.disappear[o], weights.missed[o]), weights.hidden[o]);
  for (size_t k = 0; k < new_weight.size(); ++k)
    new_weight[k] = log_add(weights.appear[k], weights.clutter[k]);
  return split(weights.total, old_weight, new_weight, options.gate);
}

double log_partition(const IdentityWeights& weights, const IdentityOptions& options) {
  const IdentityComponents components = components_of(weights, options);
  double sum = components.log_alone;
  for (const IdentityComponent& part : components.parts) sum += marginals(part).log_z;
  return sum;
}

void place_marginals(const IdentityComponent& part, const ComponentMarginals& found, PairTable& matched,
                     std::vector<double>& old_alone, std::vector<double>& new_alone) {
  auto& row_alone = part.transposed ? new_alone : old_alone;
  auto& column_alone = part.transposed ? old_alone : new_alone;
  for (size_t i = 0; i < part.rows.size(); ++i) {
    row_alone[part.rows[i]] = found.row_alone[i];
    for (size_t j = 0; j < part.columns.size(); ++j) {
      const double value = found.matched(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
      const auto row = static_cast<Eigen::Index>(part.rows[i]),
                 column = static_cast<Eigen::Index>(part.columns[j]);
      (part.transposed ? matched(column, row) : matched(row, column)) = value;
    }
  }
  for (size_t j = 0; j < part.columns.size(); ++j) column_alone[part.columns[j]] = found.column_alone[j];
}

void explain_pairs(const IdentityWeights& weights, const PairTable& matched, IdentitySolution& solution) {
  const Eigen::Index m = matched.rows(), n = matched.cols();
  solution.stay.setZero(m, n);
  solution.move.setZero(m, n);
  solution.newview.setZero(m, n);
  solution.none.setOnes(m, n);
  for (Eigen::Index o = 0; o < m; ++o)
    for (Eigen::Index k = 0; k < n; ++k) {
      const double p = matched(o, k);
      if (p == 0) continue;
      const double total = weights.total(o, k);
      solution.stay(o, k) = p * share(weights.stay(o, k), total);
      solution.move(o, k) = p * share(weights.move(o, k), total);
      solution.newview(o, k) = p * share(weights.newview(o, k), total);
      solution.none(o, k) = std::max(0.0, 1 - p);
    }
}

void explain_alone(const IdentityWeights& weights, const std::vector<double>& old_alone,
                   const std::vector<double>& new_alone, IdentitySolution& solution) {
  for (size_t k = 0; k < new_alone.size(); ++k) {
    const double total = log_add(weights.appear[k], weights.clutter[k]);
    solution.appear.push_back(new_alone[k] * share(weights.appear[k], total));
    solution.clutter.push_back(new_alone[k] * share(weights.clutter[k], total));
  }
  for (size_t o = 0; o < old_alone.size(); ++o) {
    const double total = log_add(log_add(weights.disappear[o], weights.missed[o]), weights.hidden[o]);
    solution.disappear.push_back(old_alone[o] * share(weights.disappear[o], total));
    solution.missed.push_back(old_alone[o] * share(weights.missed[o], total));
    solution.hidden.push_back(old_alone[o] * share(weights.hidden[o], total));
    // A moved object tells nothing about its old place being in view: the flag keeps its prior there.
    const double moved = solution.move.row(static_cast<Eigen::Index>(o)).sum();
    solution.out_of_view_posterior.push_back(solution.hidden[o] + weights.out_of_view[o] * moved);
  }
}

void rank(const IdentityComponents& components, const IdentityOptions& options, IdentitySolution& solution) {
  // One more than asked for tells whether the first is alone at the top.
  const auto count = static_cast<size_t>(std::max(2, options.best));
  std::vector<Matching> ranked(1);
  ranked[0].log_weight = components.log_alone;
  for (const IdentityComponent& part : components.parts)
    ranked = combine(ranked, ranked_matchings(part, count), count);
  for (Matching& matching : ranked) {
    std::sort(matching.pairs.begin(), matching.pairs.end());
    matching.log_probability = matching.log_weight - solution.log_z;
  }
  solution.map = ranked[0];
  solution.map_unique = ranked.size() < 2 || ranked[0].log_weight - ranked[1].log_weight > 1e-9;
  ranked.resize(std::min(ranked.size(), static_cast<size_t>(std::max(0, options.best))));
  solution.best = std::move(ranked);
}

}  // namespace

IdentitySolution solve(const IdentityWeights& weights, const IdentityOptions& options) {
  const size_t m = weights.old_count(), n = weights.new_count();
  const IdentityComponents components = components_of(weights, options);
  IdentitySolution solution;
  solution.gate_bound = components.gate_bound;
  solution.log_z = components.log_alone;
  PairTable matched = PairTable::Zero(weights.total.rows(), weights.total.cols());
  std::vector<double> old_alone(m, 1.0), new_alone(n, 1.0);
  for (const IdentityComponent& part : components.parts) {
    const ComponentMarginals found = marginals(part);
    solution.log_z += found.log_z;
    place_marginals(part, found, matched, old_alone, new_alone);
  }
  solution.log_evidence = solution.log_z + weights.log_reference;
  explain_pairs(weights, matched, solution);
  explain_alone(weights, old_alone, new_alone, solution);
  rank(components, options, solution);
  return solution;
}

IdentitySolution solve(const IdentityProblem& problem, const IdentityOptions& options) {
  IdentitySolution solution = solve(weights_of(problem, options), options);
  if (options.priors != ExplanationPriors{}) {
    // The probability that the formulas hold knows no unit formulas.
    IdentityOptions plain = options;
    plain.priors = {};
    const IdentityWeights weights = weights_of(problem, plain);
    solution.log_evidence = log_partition(weights, plain) + weights.log_reference;
  }
  return solution;
}

IdentitySolution solve(const LogOddsProblem& problem, const IdentityOptions& options) {
  return solve(weights_of(problem, options), options);
}

namespace {

using Candidate = std::pair<Explanation, double>;

IdentityDecision decide(const Eigen::VectorXd& partners, std::vector<Candidate> candidates, double alone) {
  IdentityDecision decision;
  decision.partner_probability = alone;
  for (Eigen::Index i = 0; i < partners.size(); ++i)
    if (partners[i] > decision.partner_probability) {
      decision.partner = static_cast<size_t>(i);
      decision.partner_probability = partners[i];
    }
  const auto likeliest =
      std::max_element(candidates.begin(), candidates.end(),
                       [](const Candidate& a, const Candidate& b) { return a.second < b.second; });
  decision.explanation = likeliest->first;
  decision.explanation_probability = likeliest->second;
  return decision;
}

}  // namespace

IdentityDecision decide_observation(const IdentitySolution& solution, size_t observation) {
  const auto k = static_cast<Eigen::Index>(observation);
  const Eigen::VectorXd partners = solution.stay.col(k) + solution.move.col(k) + solution.newview.col(k);
  return decide(partners,
                {{Explanation::stay, solution.stay.col(k).sum()},
                 {Explanation::move, solution.move.col(k).sum()},
                 {Explanation::newview, solution.newview.col(k).sum()},
                 {Explanation::appear, solution.appear[observation]},
                 {Explanation::clutter, solution.clutter[observation]}},
                solution.appear[observation] + solution.clutter[observation]);
}

IdentityDecision decide_object(const IdentitySolution& solution, size_t object) {
  const auto o = static_cast<Eigen::Index>(object);
  const Eigen::VectorXd partners =
      (solution.stay.row(o) + solution.move.row(o) + solution.newview.row(o)).transpose();
  return decide(partners,
                {{Explanation::stay, solution.stay.row(o).sum()},
                 {Explanation::move, solution.move.row(o).sum()},
                 {Explanation::newview, solution.newview.row(o).sum()},
                 {Explanation::disappear, solution.disappear[object]},
                 {Explanation::missed, solution.missed[object]},
                 {Explanation::hidden, solution.hidden[object]}},
                solution.disappear[object] + solution.missed[object] + solution.hidden[object]);
}

}  // namespace loci::memory
