#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <set>

#include "tests/support/mln/markov_logic.h"

namespace loci::mln {
namespace {

void collect_variables(const GroundFormula& formula, std::set<size_t>& variables) {
  if (formula.kind == Formula::Kind::atom) variables.insert(formula.variable);
  for (const GroundFormula& part : formula.parts) collect_variables(part, variables);
}

/// Assigns one variable after the other; each formula is looked at as soon as it is decided, so that
/// forbidden worlds are left early.
class Enumeration {
 public:
  Enumeration(const GroundNetwork& network, size_t max_worlds)
      : network_(network), max_worlds_(max_worlds), world_(network.variables.size(), 0) {
    std::vector<std::set<size_t>> uses;
    for (const GroundClause& clause : network.clauses) collect_variables(clause.formula, uses.emplace_back());
    std::vector<size_t> by_size(uses.size());
    std::iota(by_size.begin(), by_size.end(), size_t{0});
    std::stable_sort(by_size.begin(), by_size.end(),
                     [&](size_t a, size_t b) { return uses[a].size() < uses[b].size(); });
    std::vector<size_t> rank(world_.size(), kNone);
    const auto place = [&](size_t variable) {
      if (rank[variable] != kNone) return;
      rank[variable] = order_.size();
      order_.push_back(variable);
    };
    for (const size_t clause : by_size)
      for (const size_t variable : uses[clause]) place(variable);
    for (size_t variable = 0; variable < world_.size(); ++variable) place(variable);
    decided_.resize(order_.size() + 1);
    for (size_t clause = 0; clause < uses.size(); ++clause) {
      size_t last = 0;
      for (const size_t variable : uses[clause]) last = std::max(last, rank[variable] + 1);
      decided_[last].push_back(&network.clauses[clause]);
    }
    for (const GroundVariable& variable : network.variables) sums_.emplace_back(variable.log_weight.size());
  }

  Marginals run() {
    double log_weight = 0;
    if (add_decided(0, log_weight)) descend(0, log_weight);
    if (!(z_ > 0)) throw Error("no world satisfies the hard formulas and the evidence");
    Marginals result;
    result.log_z = std::log(z_);
    result.worlds = worlds_;
    for (const auto& [name, where] : network_.atoms)
      result.probability[name] = sums_[where.first][static_cast<size_t>(where.second)] / z_;
    return result;
  }

 private:
  static constexpr size_t kNone = std::numeric_limits<size_t>::max();

  bool add_decided(size_t depth, double& log_weight) const {
    for (const GroundClause* clause : decided_[depth]) {
      const bool holds = clause->formula.holds(world_);
      if (clause->hard && !holds) return false;
      if (!clause->hard && holds) log_weight += clause->weight;
    }
    return true;
  }

  void descend(size_t depth, double log_weight) {
    if (depth == order_.size()) {
      if (++worlds_ > max_worlds_)
        throw Error("the network has more than " + std::to_string(max_worlds_) + " possible worlds", {},
                    "enumeration is for small domains");
      const double weight = std::exp(log_weight);
      z_ += weight;
      for (size_t i = 0; i < world_.size(); ++i) sums_[i][static_cast<size_t>(world_[i])] += weight;
      return;
    }
    const size_t variable = order_[depth];
    const std::vector<double>& weights = network_.variables[variable].log_weight;
    for (size_t value = 0; value < weights.size(); ++value) {
      if (std::isinf(weights[value])) continue;
      world_[variable] = static_cast<int>(value);
      double sum = log_weight + weights[value];
      if (add_decided(depth + 1, sum)) descend(depth + 1, sum);
    }
  }

  const GroundNetwork& network_;
  size_t max_worlds_;
  std::vector<int> world_;
  std::vector<size_t> order_;
  std::vector<std::vector<const GroundClause*>> decided_;  ///< after that many variables
  std::vector<std::vector<double>> sums_;                  ///< per variable and value
  double z_ = 0;
  size_t worlds_ = 0;
};

}  // namespace

double Marginals::of(const std::string& atom) const {
  const auto found = probability.find(atom);
  if (found == probability.end()) throw Error("'" + atom + "' is no atom of the network");
  return found->second;
}

Marginals enumerate(const GroundNetwork& network, size_t max_worlds) {
  return Enumeration(network, max_worlds).run();
}

}  // namespace loci::mln
