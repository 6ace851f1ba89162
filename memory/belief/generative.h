#pragma once

#include "memory/belief/rates.h"

namespace loci::belief {

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

/// Log density of seeing `seen` given that it is the number `believed`, against its being any number of the
/// domain. True numbers lie in `possible`; that this one was seen at all tells that it lies in `visible`.
/// Noise may carry measurements beyond the borders, which is where a plain Gaussian is most wrong.
double log_same(const Measured& believed, const Domain& possible, const Measured& seen,
                const Domain& visible);

/// What became of an object in a time in which each kind of change happened at its rate.
class Fates {
 public:
  /// `gap` since it was last seen, on the objects' clock.
  Fates(const ChangeRates& rates, double gap);

  double stays() const { return stays_; }      ///< as and where it was
  double changed() const { return changed_; }  ///< where it was, looking different
  /// Looks the same, somewhere else, put there within the last `window`: what was looked at before that shows
  /// where it is not.
  double moved(double window) const;
  double returned(double window) const;  ///< the same after it had been taken away

 private:
  double removed_rate_, moved_rate_, returned_rate_;
  double fading_rate_;  ///< of not being recognised elsewhere: removed or changed
  double gap_;
  double stays_, changed_;
};

/// Expected number per square metre of things that are not believed in, where nobody looked for `time`.
/// `leaving`: rate at which they leave again.
double untracked(double arrival_rate, double leaving, double time);

/// Estimates the variance of measurements from pairs that are probably the same and unchanged.
class NoiseEstimate {
 public:
  /// Starts from a wide guess: too small a one would take noise for change.
  explicit NoiseEstimate(double start_sigma);
  /// Knows the answer.
  static NoiseEstimate known(double sigma);

  double variance() const { return known_ ? start_variance_ : (squares_ / count_); }
  /// `difference` of a measurement to a mean of `looks` measurements, which are the same with `probability`.
  void count(double difference, double looks, double probability);

 private:
  bool known_ = false;
  double start_variance_ = 1;
  double squares_ = 0, count_ = 0;
};

}  // namespace loci::belief
