#pragma once

namespace loci::apps::identity_experiment {

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

/// Estimates the variance of measurements from pairs that are probably the same and unchanged. Old evidence
/// fades.
class NoiseEstimate {
 public:
  /// Starts from an upper bound: a low one would take noise for change.
  explicit NoiseEstimate(double start_sigma);
  /// Fixed.
  static NoiseEstimate known(double sigma);

  double variance() const { return squares_ / count_; }
  /// `difference` of a measurement to a mean of `views` measurements, which are the same with `probability`.
  void count(double difference, double views, double probability);

 private:
  static constexpr double kMemory = 300;  ///< differences after which evidence counts for 1/e
  bool known_ = false;
  double squares_ = 0, count_ = 0;
};

}  // namespace loci::apps::identity_experiment
