#pragma once

#include <array>
#include <map>
#include <string>

#include "memory/belief/evidence/noise_scale.h"
#include "memory/belief/evidence/similarity.h"

namespace loci::memory::belief {

/// Learned evidence of descriptor distances in this home: distances between views of one object against
/// distances between different objects. Starts with the tables of comparisons() and stays near them until
/// there is data.
class Calibration {
 public:
  /// Histograms of the distances of one kind. Old data fades.
  struct Counts {
    std::array<float, Correction::kBins> same{}, different{};

    void count(bool same_object, double distance, double weight);
    void fade();
  };
  /// By kind; colours of achromatic objects apart.
  using CountsByKind = std::map<std::string, Counts>;

  Calibration() = default;
  explicit Calibration(CountsByKind counts) : counts_(std::move(counts)) {}
  const CountsByKind& counts() const { return counts_; }

  /// `kind` as in comparisons().
  Counts& of(size_t kind, bool achromatic);

  Corrections corrections() const;
  /// Noise of mean colours between two views of one object, relative to kColorVariance.
  const NoiseScale& color_noise() const { return color_noise_; }
  void set_color_noise(const NoiseScale& noise) { color_noise_ = noise; }
  /// Two mean colours, whose channels have this root mean square difference, are of one unchanged object with
  /// a probability.
  void count_color(double distance, double probability);

 private:
  NoiseScale color_noise_;
  CountsByKind counts_;
};

}  // namespace loci::memory::belief
