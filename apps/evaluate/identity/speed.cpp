#include <algorithm>

#include "apps/evaluate/identity/experiment.h"
#include "mapping/base/math/random.h"
#include "mapping/base/stopwatch.h"

namespace loci::apps::identity_experiment {
namespace {

/// Objects in groups of `block` that may be confused with each other; pairs of different groups are as unlike
/// as calibrated evidence makes them.
memory::LogOddsProblem problem_of(Eigen::Index size, Eigen::Index block, Random random) {
  memory::LogOddsProblem problem;
  problem.log_similar.resize(size, size);
  problem.log_proximity.resize(size, size);
  for (Eigen::Index o = 0; o < size; ++o)
    for (Eigen::Index k = 0; k < size; ++k) {
      const bool same_block = o / block == k / block;
      problem.log_similar(o, k) = same_block ? random.uniform(-3, 3) : random.uniform(-60, -30);
      problem.log_proximity(o, k) = same_block ? random.uniform(-3, 3) : random.uniform(-60, -30);
    }
  for (Eigen::Index o = 0; o < size; ++o) problem.out_of_view.push_back(random.uniform(0, 0.5));
  return problem;
}

SpeedRow measure(const std::string& name, Eigen::Index size, Eigen::Index block, double aim, int seed) {
  const memory::LogOddsProblem problem = problem_of(size, block, Random(static_cast<uint64_t>(seed)));
  memory::IdentityOptions options;
  options.best = 1;
  SpeedRow row{name, 1e300, aim, 0};
  const double start = thread_cpu_seconds();
  for (int repeat = 0; repeat < 200; ++repeat) {
    const double before = thread_cpu_seconds();
    row.gate_bound = solve(problem, options).gate_bound;
    const double after = thread_cpu_seconds();
    row.milliseconds = std::min(row.milliseconds, 1000 * (after - before));
    if (repeat >= 5 && after - start > 1) break;
  }
  return row;
}

}  // namespace

std::vector<SpeedRow> measure_speed(int seed) {
  return {measure("10 x 10 dense", 10, 10, 0.1, seed), measure("16 x 16 dense", 16, 16, 15, seed),
          measure("50 x 50 gated, groups of 5", 50, 5, 0.5, seed),
          measure("50 x 50 gated, groups of 10", 50, 10, 0, seed)};
}

}  // namespace loci::apps::identity_experiment
