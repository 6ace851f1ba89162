#pragma once

#include "memory/identity/components.h"

namespace loci::memory {

struct ComponentMarginals {
  PairTable matched;              ///< rows × columns: probability of the pair
  std::vector<double> row_alone;  ///< probability of staying unmatched
  std::vector<double> column_alone;
  double log_z = 0;  ///< includes the component's scale
};

/// Forward-backward over the columns in their elimination order, with a weight per subset of the open rows:
/// O(pairs · 2^width) time.
ComponentMarginals marginals(const IdentityComponent& component);

}  // namespace loci::memory
