#pragma once

#include <array>
#include <limits>
#include <utility>

#include "memory/belief/similarity.h"

namespace loci::memory::belief {

/// How many kinds of descriptors comparisons() knows.
inline constexpr size_t kComparisons = 5;

/// A look made ready for being compared many times. Refers to its descriptors, which must outlive it.
class Appearance {
 public:
  explicit Appearance(const std::vector<Descriptor>& descriptors);

  struct Feature {
    const std::vector<float>* values = nullptr;  ///< unset = no descriptor of this kind
    bool named = false;
    std::vector<std::pair<const std::string*, float>> by_name;  ///< in order of the names, each once
    std::vector<double> log_extents;                            ///< where extents are compared
  };
  const std::array<Feature, kComparisons>& features() const { return features_; }
  /// Whether it is nearly without colour. Most things in kitchens are white or grey: that two are alike in
  /// this says little.
  bool colorless() const { return colorless_; }

 private:
  std::array<Feature, kComparisons> features_;
  bool colorless_;
};

/// What was learned to add to a comparison's table: log-likelihood ratios at the middles of some distances.
struct Correction {
  static constexpr size_t kBins = 12;
  std::array<double, kBins> values{};

  double at(double distance) const;
};
/// By kind, in the order of comparisons(); the second is for two things without colour.
using Corrections = std::array<std::array<Correction, 2>, kComparisons>;

/// Log-likelihood ratio before anything was learned.
double prior_log_ratio(const Comparison& comparison, double distance, bool colorless);

/// What comparing two looks gave, in the order of comparisons().
struct Contrast {
  struct Part {
    double distance = std::numeric_limits<double>::quiet_NaN();  ///< NaN = not comparable
    double log_ratio = 0;
  };
  std::array<Part, kComparisons> parts;
  bool colorless = false;    ///< both are
  size_t count = 0;          ///< of parts that are comparable
  double log_ratio = 0;      ///< combined evidence
  double log_closeness = 0;  ///< mean over the parts
};

/// compare() of similarity.h, without its copies.
Contrast contrast(const Appearance& a, const Appearance& b, bool partial, double weight,
                  const Corrections& corrections = {});

}  // namespace loci::memory::belief
