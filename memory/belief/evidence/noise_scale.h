#pragma once

#include <array>
#include <cstddef>

namespace loci::memory::belief {

/// How large position errors between two view points are, relative to what the options state: a distribution
/// over factors on the standard deviation, learned from objects that stayed. While little is known, the
/// mixture over the factors gives the likelihood heavy tails, so that a wrong statement corrects itself.
class NoiseScale {
 public:
  static constexpr std::array<double, 12> kFactors{0.09, 0.125, 0.18, 0.25, 0.35, 0.5,
                                                   0.7,  1,     1.4,  2,    2.8,  4};
  static constexpr size_t kLevels = kFactors.size();
  using Levels = std::array<double, kLevels>;

  NoiseScale() = default;
  explicit NoiseScale(const Levels& counts) : counts_(counts) {}
  /// Offsets explained by each factor so far; recent ones count more.
  const Levels& counts() const { return counts_; }

  /// Probability of each factor. `spread`: standard deviation of the factor's logarithm before anything is
  /// known.
  Levels weights(double spread) const;
  /// The same without factors far from the mean: what differs that much has changed, or is another object.
  Levels main_weights(double spread) const;
  /// Expected factor on the variance.
  double variance_factor(double spread) const;
  /// An offset was observed that is, with a probability, an error only. `density`: its likelihood by factor.
  void count(const Levels& density, double probability, double spread);

 private:
  Levels counts_{};
};

}  // namespace loci::memory::belief
