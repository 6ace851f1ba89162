#pragma once

#include <array>
#include <map>
#include <string>

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

 private:
  CountsByKind counts_;
};

}  // namespace loci::memory::belief
