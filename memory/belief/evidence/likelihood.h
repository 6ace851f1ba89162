#pragma once

namespace loci::memory::belief {

/// Interval of possible values.
struct Domain {
  double low = 0, high = 1;
};

/// Measurement with Gaussian noise.
struct Measured {
  double mean = 0, variance = 1;
};

/// Probability that the value lies in the domain.
double mass(const Measured& number, const Domain& domain);

/// Log-likelihood ratio of measuring `seen`: the same value as `believed`, against any value of the domain.
/// True values lie in `possible`, observed ones in `visible`. A plain Gaussian is wrong where noise exceeds
/// the borders.
double log_same(const Measured& believed, const Domain& possible, const Measured& seen,
                const Domain& visible);

}  // namespace loci::memory::belief
