#pragma once

#include <array>
#include <map>
#include <string>

#include "memory/belief/appearance.h"

namespace loci::memory::belief {

/// What the distances of annotations tell in this home: learned from how much they vary between looks at the
/// same thing and between looks at different ones. Begins with the tables of comparisons() and stays near
/// them until there is evidence.
class Calibration {
 public:
  /// How often distances of one kind fell into each bin. Old evidence fades.
  class Counts {
   public:
    /// Between looks that are surely of the same thing, or of two.
    void count(bool same, double distance, double weight);
    void fade();

    template <class Archive>
    void archive(Archive& fields) {
      fields(same_, different_);
    }

   private:
    friend class Calibration;
    std::array<float, Correction::kBins> same_{}, different_{};
  };

  /// `kind` as in comparisons(); what two things without colour have in common tells less.
  Counts& of(size_t kind, bool colorless);

  /// What to add to the tables.
  Corrections corrections() const;

  template <class Archive>
  void archive(Archive& fields) {
    fields(counts_);
  }

 private:
  std::map<std::string, Counts> counts_;  ///< by kind; of colours apart for things without
};

}  // namespace loci::memory::belief
