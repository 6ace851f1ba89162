#pragma once

#include <vector>

#include "mapping/interpretation/face_raster.h"

namespace loci::mapping {

/// How far the surface of a face stands before its plane, place by place: fronts before the body, panels in
/// frames. Where two layers meet, it is the one in front; handles and knobs are too small to count.
class FaceGround {
 public:
  explicit FaceGround(const FaceRays& rays);

  /// Depth against the plane, metres; 0 where too little was seen.
  double at(double u, double v) const;

 private:
  static constexpr int kCells = 10;  ///< of the raster per side of a patch

  FaceGrid grid_;
  int width_ = 0, height_ = 0;
  std::vector<float> depth_;
};

}  // namespace loci::mapping
