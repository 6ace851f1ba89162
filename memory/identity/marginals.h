#pragma once

#include "memory/identity/components.h"

namespace loci::memory {

struct ComponentMarginals {
  PairTable matched;              ///< rows × columns: probability of the pair
  std::vector<double> row_alone;  ///< probability of staying unmatched
  std::vector<double> column_alone;
  double log_z = 0;  ///< includes the component's scale
};

/// Forward-backward over the subsets of the rows, one column at a time. O(rows · columns · 2^rows) time.
ComponentMarginals marginals(const IdentityComponent& component);

}  // namespace loci::memory
