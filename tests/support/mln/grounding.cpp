#include "tests/support/mln/markov_logic.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

namespace loci::mln {
namespace {

constexpr double kNever = -std::numeric_limits<double>::infinity();
using Binding = std::map<std::string, std::string>;

class Grounder {
 public:
  explicit Grounder(const Network& network) : network_(network) {}

  GroundNetwork run() {
    for (const Predicate& predicate : network_.predicates) add_variables(predicate);
    for (const SoftEvidence& evidence : network_.evidence) add_evidence(evidence);
    for (const WeightedFormula& formula : network_.formulas) {
      std::map<std::string, std::string> domains;
      collect(formula.formula, {}, domains, formula.line);
      std::vector<std::pair<std::string, std::string>> free(domains.begin(), domains.end());
      for_all(free, 0, {}, [&](const Binding& binding) {
        result_.clauses.push_back({ground(formula.formula, binding), formula.weight, formula.hard});
      });
    }
    return std::move(result_);
  }

 private:
  const std::vector<std::string>& constants_of(const std::string& domain) const {
    const auto found = network_.domains.find(domain);
    if (found == network_.domains.end()) throw Error("the domain '" + domain + "' has no constants");
    return found->second;
  }

  /// All bindings of variables to the constants of their domains.
  template <class Visit>
  void for_all(const std::vector<std::pair<std::string, std::string>>& variables, size_t index,
               Binding binding, const Visit& visit) const {
    if (index == variables.size()) {
      visit(binding);
      return;
    }
    for (const std::string& constant : constants_of(variables[index].second)) {
      binding[variables[index].first] = constant;
      for_all(variables, index + 1, binding, visit);
    }
  }

  void add_variables(const Predicate& predicate) {
    std::vector<std::pair<std::string, std::string>> arguments;
    for (size_t i = 0; i < predicate.domains.size(); ++i)
      if (predicate.functional != i) arguments.emplace_back(std::to_string(i), predicate.domains[i]);
    for_all(arguments, 0, {}, [&](const Binding& binding) {
      const size_t variable = result_.variables.size();
      std::vector<std::string> constants(predicate.domains.size());
      for (const auto& [index, constant] : binding) constants[std::stoul(index)] = constant;
      if (!predicate.functional) {
        result_.atoms[atom_name(predicate.name, constants)] = {variable, 1};
        result_.variables.push_back({{0.0, 0.0}});
        return;
      }
      const auto& values = constants_of(predicate.domains[*predicate.functional]);
      for (size_t value = 0; value < values.size(); ++value) {
        constants[*predicate.functional] = values[value];
        result_.atoms[atom_name(predicate.name, constants)] = {variable, static_cast<int>(value)};
      }
      result_.variables.push_back({std::vector<double>(values.size(), 0.0)});
    });
  }

  void add_evidence(const SoftEvidence& evidence) {
    const std::string name = atom_name(evidence.predicate, evidence.constants);
    const auto found = result_.atoms.find(name);
    if (found == result_.atoms.end()) throw Error("evidence: '" + name + "' is no atom of the network");
    if (network_.find(evidence.predicate)->functional)
      throw Error("evidence: '" + name + "' is of a functional predicate");
    const double p = evidence.probability;
    result_.variables[found->second.first].log_weight = {p < 1 ? std::log1p(-p) : kNever,
                                                         p > 0 ? std::log(p) : kNever};
  }

  /// Free variables with their domains.
  void collect(const Formula& formula, std::set<std::string> bound,
               std::map<std::string, std::string>& domains, int line) const {
    if (formula.kind == Formula::Kind::exists) bound.insert(formula.terms.begin(), formula.terms.end());
    if (formula.kind == Formula::Kind::atom) {
      const Predicate& predicate = *network_.find(formula.predicate);
      for (size_t i = 0; i < formula.terms.size(); ++i) {
        const std::string& term = formula.terms[i];
        if (bound.count(term) > 0 || network_.is_constant(term)) continue;
        const auto [known, fresh] = domains.emplace(term, predicate.domains[i]);
        if (!fresh && known->second != predicate.domains[i])
          throw Error("'" + term + "' stands for things of two domains", {{}, line, {}});
      }
    }
    for (const Formula& part : formula.parts) collect(part, bound, domains, line);
  }

  /// Domain of a variable by its use inside a formula.
  std::string domain_of(const std::string& variable, const Formula& formula) const {
    if (formula.kind == Formula::Kind::atom)
      for (size_t i = 0; i < formula.terms.size(); ++i)
        if (formula.terms[i] == variable) return network_.find(formula.predicate)->domains[i];
    for (const Formula& part : formula.parts)
      if (std::string domain = domain_of(variable, part); !domain.empty()) return domain;
    return {};
  }

  GroundFormula ground(const Formula& formula, const Binding& binding) const {
    const auto value_of = [&](const std::string& term) {
      const auto found = binding.find(term);
      return found == binding.end() ? term : found->second;
    };
    GroundFormula result;
    result.kind = formula.kind;
    if (formula.kind == Formula::Kind::atom) {
      std::vector<std::string> constants;
      for (const std::string& term : formula.terms) constants.push_back(value_of(term));
      const std::string name = atom_name(formula.predicate, constants);
      const auto found = result_.atoms.find(name);
      if (found == result_.atoms.end()) throw Error("'" + name + "' is no atom of the network");
      std::tie(result.variable, result.value) = found->second;
    } else if (formula.kind == Formula::Kind::equal) {
      // Nothing left to choose: the empty conjunction is true, the empty disjunction false.
      result.kind = value_of(formula.terms[0]) == value_of(formula.terms[1]) ? Formula::Kind::conjunction
                                                                             : Formula::Kind::disjunction;
    } else if (formula.kind == Formula::Kind::exists) {
      result.kind = Formula::Kind::disjunction;
      std::vector<std::pair<std::string, std::string>> variables;
      for (const std::string& variable : formula.terms)
        variables.emplace_back(variable, domain_of(variable, formula.parts[0]));
      for_all(variables, 0, binding,
              [&](const Binding& inner) { result.parts.push_back(ground(formula.parts[0], inner)); });
    } else {
      for (const Formula& part : formula.parts) result.parts.push_back(ground(part, binding));
    }
    return result;
  }

  const Network& network_;
  GroundNetwork result_;
};

}  // namespace

std::string atom_name(const std::string& predicate, const std::vector<std::string>& constants) {
  std::string name = predicate + "(";
  for (size_t i = 0; i < constants.size(); ++i) name += (i > 0 ? "," : "") + constants[i];
  return name + ")";
}

bool GroundFormula::holds(const std::vector<int>& world) const {
  const auto part_holds = [&](const GroundFormula& part) { return part.holds(world); };
  switch (kind) {
    case Formula::Kind::atom:
      return world[variable] == value;
    case Formula::Kind::negation:
      return !parts[0].holds(world);
    case Formula::Kind::conjunction:
      return std::all_of(parts.begin(), parts.end(), part_holds);
    case Formula::Kind::implication:
      return !parts[0].holds(world) || parts[1].holds(world);
    case Formula::Kind::equivalence:
      return parts[0].holds(world) == parts[1].holds(world);
    default:
      return std::any_of(parts.begin(), parts.end(), part_holds);
  }
}

GroundNetwork ground(const Network& network) {
  return Grounder(network).run();
}

}  // namespace loci::mln
