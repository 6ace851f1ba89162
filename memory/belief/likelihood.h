#pragma once

namespace loci::memory::belief {

/// Where a number can lie.
struct Domain {
  double low = 0, high = 1;
};

/// A number known up to Gaussian noise.
struct Measured {
  double mean = 0, variance = 1;
};

/// Probability that the number lies in the domain.
double mass(const Measured& number, const Domain& domain);

/// Log density of measuring `seen` given that it is the number `believed`, against its being any number of
/// the domain. True numbers lie in `possible`; that this one was seen at all tells that it lies in `visible`.
/// Noise may carry measurements beyond the borders, which is where a plain Gaussian is most wrong.
double log_same(const Measured& believed, const Domain& possible, const Measured& seen,
                const Domain& visible);

/// Estimates the variance of measurements from pairs that are probably the same and unchanged. Old evidence
/// fades, so that a bad start does not last.
class NoiseEstimate {
 public:
  /// Starts from a wide guess: too small a one would take noise for change.
  explicit NoiseEstimate(double start_sigma);
  /// Knows the answer.
  static NoiseEstimate known(double sigma);

  double variance() const { return squares_ / count_; }
  /// `difference` of a measurement to a mean of `looks` measurements, which are the same with `probability`.
  void count(double difference, double looks, double probability);

 private:
  static constexpr double kMemory = 300;  ///< differences after which evidence counts for 1/e
  bool known_ = false;
  double squares_ = 0, count_ = 0;
};

}  // namespace loci::memory::belief
