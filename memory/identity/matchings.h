#pragma once

#include "memory/identity/components.h"
#include "memory/identity/solution.h"

namespace loci::memory {

/// The `count` heaviest matchings of a component, heaviest first, with log weights that include its scale
/// (Murty's partition over augmenting paths). Pairs are (old, new) of the whole problem.
std::vector<Matching> ranked_matchings(const IdentityComponent& component, size_t count);

/// The `count` heaviest combinations of one matching of each list.
std::vector<Matching> combine(const std::vector<Matching>& a, const std::vector<Matching>& b, size_t count);

}  // namespace loci::memory
