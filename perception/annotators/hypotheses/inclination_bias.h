#pragma once

#include <array>

#include "perception/annotators/hypotheses/disparity_kernels.h"

namespace loci::perception {

/// By how much estimated normals lean too little or too much, by their inclination to the sensor's plane
/// (§4.2.1.1): a table in bins of 5°, as in Fig. 4.4, and its inverse, a rotation about z × n (Eq. 4.6). The
/// default corrects nothing.
class InclinationBias {
 public:
  static constexpr int kBins = 18;
  static constexpr double kBinDeg = 5;
  using Table = std::array<double, kBins>;

  InclinationBias() = default;
  /// `correction_deg` of a bin is what is added to an estimated inclination in its middle; between middles it
  /// is interpolated, and it vanishes at 0 and 90°.
  explicit InclinationBias(const Table& correction_deg);

  const Table& correction_deg() const { return correction_deg_; }
  /// The rotation as what is added to the z of a unit normal, by the cosine of its inclination.
  const CosineTable& tilt() const { return tilt_; }

 private:
  Table correction_deg_ = {};
  CosineTable tilt_ = {};
};

}  // namespace loci::perception
