#pragma once

#include <array>
#include <cstdint>

namespace loci {

/// Random numbers (xoshiro256**, Blackman and Vigna 2018) with the same
/// sequence on every machine, unlike the distributions of <random>. Functions that draw take one.
class Random {
 public:
  explicit Random(uint64_t seed);

  /// An independent generator for part `stream` of the work, the same on any thread.
  Random fork(uint64_t stream) const;

  uint64_t bits();
  /// Uniform in [0,1).
  double uniform();
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  /// Uniform in {0, …, count-1}; count > 0.
  uint64_t index(uint64_t count);
  /// Normal with mean 0 and the given standard deviation (Marsaglia's polar method).
  double normal(double sigma = 1.0);

 private:
  std::array<uint64_t, 4> state_;
  double spare_ = 0.0;
  bool has_spare_ = false;
};

}  // namespace loci
