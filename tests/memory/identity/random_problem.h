#pragma once

#include "mapping/base/math/random.h"
#include "memory/identity/solution.h"

namespace loci::memory::testing_support {

/// A random problem in which about a third of the entries are zero.
inline IdentityProblem random_problem(size_t m, size_t n, Random& random, bool views = true) {
  IdentityProblem problem;
  problem.old_count = m;
  problem.new_count = n;
  const auto entry = [&] { return random.uniform() < 0.3 ? 0.0 : random.uniform(); };
  for (size_t o = 0; o < m; ++o) {
    problem.similar.emplace_back();
    problem.proximity.emplace_back();
    for (size_t k = 0; k < n; ++k) {
      problem.similar[o].emplace_back(entry());
      problem.proximity[o].emplace_back(entry());
    }
    problem.out_of_view.push_back(views && random.uniform() < 0.5 ? random.uniform() : 0.0);
  }
  return problem;
}

}  // namespace loci::memory::testing_support
