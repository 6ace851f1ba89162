#pragma once

// Markov logic networks small enough to be enumerated: proves the solver of memory/identity right.

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "mapping/base/error.h"

namespace loci::mln {

/// A predicate and the domains of its arguments. At most one argument is functional ("!"): for the others
/// given, the predicate holds for exactly one of its values.
struct Predicate {
  std::string name;
  std::vector<std::string> domains;
  std::optional<size_t> functional;
};

/// A formula as a tree.
struct Formula {
  enum class Kind { atom, equal, negation, conjunction, disjunction, implication, equivalence, exists };
  Kind kind = Kind::atom;
  std::string predicate;  ///< of an atom
  std::vector<std::string>
      terms;  ///< of an atom or an equality: constants or variables; of exists: variables
  std::vector<Formula> parts;
};

/// A formula with its weight; hard = infinite.
struct WeightedFormula {
  Formula formula;
  double weight = 0;
  bool hard = false;
  int line = 0;
};

/// An atom's truth given from outside: a probability, 0 or 1 being certain.
struct SoftEvidence {
  std::string predicate;
  std::vector<std::string> constants;
  double probability = 1;
  int line = 0;
};

/// A Markov logic network with its domains and evidence, in the usual syntax:
///
///     explanations = {move, stay, newview, not}     a domain
///     similar(oldCluster, newCluster)               a predicate
///     is(oldCluster, newCluster, explanations!)     a functional one
///     outOfView(o) => !(EXIST n (is(o,n,stay))).    a hard formula ends in a full stop
///     1.5 similar(o,n) ^ proximity(o,n)             a weight makes it soft
///
/// with ! ^ v => <=> = and parentheses; free variables are universally quantified; a name is a constant if a
/// domain has it, otherwise a variable. Evidence is `0.7 similar(O1,N1)`, `similar(O1,N1)` or
/// `!similar(O1,N1)`.
struct Network {
  std::map<std::string, std::vector<std::string>> domains;
  std::vector<Predicate> predicates;
  std::vector<WeightedFormula> formulas;
  std::vector<SoftEvidence> evidence;

  /// Adds what the text says. Error with file and line.
  void read(std::string_view text, const std::string& file = {});
  /// Adds evidence and the domains of this instance.
  void read_evidence(std::string_view text, const std::string& file = {});

  const Predicate* find(const std::string& name) const;
  bool is_constant(const std::string& name) const;
};

/// A formula without variables. Atoms are "variable has value".
struct GroundFormula {
  Formula::Kind kind = Formula::Kind::conjunction;
  size_t variable = 0;
  int value = 1;
  std::vector<GroundFormula> parts;

  bool holds(const std::vector<int>& world) const;
};

/// Something that can take one of some values: an atom (false, true), or a functional atom's value.
struct GroundVariable {
  std::vector<double> log_weight;  ///< per value, from soft evidence; -infinity = excluded
};

struct GroundClause {
  GroundFormula formula;
  double weight = 0;
  bool hard = false;
};

/// A network over its constants.
struct GroundNetwork {
  std::vector<GroundVariable> variables;
  std::vector<GroundClause> clauses;
  /// "is(O1,N1,stay)" to the variable and its value.
  std::map<std::string, std::pair<size_t, int>> atoms;
};

std::string atom_name(const std::string& predicate, const std::vector<std::string>& constants);

/// Soft evidence p makes an atom true with odds p / (1 - p), independently of everything else before the
/// formulas are imposed. Error for empty or unknown domains and for evidence about functional predicates.
GroundNetwork ground(const Network& network);

/// Exact marginals by enumeration of all worlds that no hard formula forbids.
struct Marginals {
  std::map<std::string, double> probability;  ///< per atom name
  double log_z = 0;
  size_t worlds = 0;

  double of(const std::string& atom) const;
};

/// Error when there is no world, or more than `max_worlds`.
Marginals enumerate(const GroundNetwork& network, size_t max_worlds = 20'000'000);

}  // namespace loci::mln
