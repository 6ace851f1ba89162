#pragma once

#include <optional>

#include "memory/ingest/detections.h"

namespace loci::memory {

/// Estimates how much detected positions scatter, from moments that follow each other: most things do not
/// move between two looks, so that the median distance of nearest detections is noise. Robust against what
/// moves and against what is missing.
class PositionNoise {
 public:
  void add(const DetectedScene& scene);
  /// Standard deviation per axis, metres; unset when too little was seen twice.
  std::optional<double> sigma_m() const;

  static constexpr double kDefault_m = 0.02;  ///< where nothing can be estimated

 private:
  std::vector<Detection> before_;
  std::vector<double> differences_;  ///< per axis, of what was probably the same
};

}  // namespace loci::memory
