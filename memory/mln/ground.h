#pragma once

#include <map>
#include <string>
#include <vector>

#include "memory/mln/network.h"

namespace loci::memory::mln {

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

}  // namespace loci::memory::mln
