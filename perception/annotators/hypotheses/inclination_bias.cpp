#include "perception/annotators/hypotheses/inclination_bias.h"

#include <algorithm>
#include <cmath>

#include "mapping/base/math.h"

namespace loci::perception {
namespace {

/// Linear between the middles of the bins, 0 at both ends.
double interpolate(const InclinationBias::Table& table, double inclination_deg) {
  const double position = inclination_deg / InclinationBias::kBinDeg - 0.5;
  const auto bin = static_cast<int>(std::floor(position));
  const auto value = [&](int b) {
    return b < 0 || b >= InclinationBias::kBins ? 0.0 : table[static_cast<size_t>(b)];
  };
  // The outer halves of the first and the last bin go from 0 at the end to the middle's value.
  if (bin < 0) return 2 * (position + 0.5) * value(0);
  if (bin >= InclinationBias::kBins - 1) return 2 * (InclinationBias::kBins - 0.5 - position) * value(bin);
  return value(bin) + (position - bin) * (value(bin + 1) - value(bin));
}

}  // namespace

InclinationBias::InclinationBias(const Table& correction_deg) : correction_deg_(correction_deg) {
  for (int i = 0; i < kCosineSteps; ++i) {
    const double cosine = static_cast<double>(i) / kCosineSteps;
    const double inclination = std::acos(cosine) / kDegree;
    const double wanted = std::clamp(inclination + interpolate(correction_deg, inclination), 0.1, 89.9);
    // The normal (sin, -cos) gets the direction (sin w, -cos w) when its z is shortened to sin / tan w.
    tilt_[static_cast<size_t>(i)] =
        static_cast<float>(cosine - std::sin(inclination * kDegree) / std::tan(wanted * kDegree));
  }
  tilt_[kCosineSteps] = tilt_[kCosineSteps - 1];
}

}  // namespace loci::perception
