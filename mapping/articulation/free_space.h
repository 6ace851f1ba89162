#pragma once

#include <vector>

#include "mapping/sensor/scan.h"

namespace loci::mapping {

/// Which space the rays of a scan set passed through: per origin an image of the distances in all
/// directions, in steps of half a degree.
class FreeSpace {
 public:
  /// `near` is what it will be asked about: origins within reach of it are kept. A point counts as free when
  /// rays around it went on by `tolerance` metres.
  FreeSpace(const ScanSet& set, const Vector3d& near, double tolerance);

  bool is_free(const Vector3d& point) const;
  /// The share of points that are free.
  double share_free(const std::vector<Vector3d>& points) const;

 private:
  struct View {
    Vector3d origin;
    std::vector<float> least;  ///< metres by direction; infinity = no ray
  };

  double tolerance_;
  std::vector<View> views_;
};

}  // namespace loci::mapping
