#pragma once

#include <opencv2/core.hpp>

#include "mapping/interpretation/fronts/furniture_face.h"

namespace loci::mapping {

/// The colours of a furniture face as from an infinite distance before it. The first row is at the top, the
/// first column at the left of a person before the face. What stands before the face is displaced.
struct FacePhoto {
  FurnitureFace face;
  double pixel_m = 0;     ///< size of a pixel
  double u0 = 0, v0 = 0;  ///< left edge of the first column, lower edge of the last row
  cv::Mat color;          ///< CV_8UC3, BGR; black where nothing was seen

  double column(double u) const { return (u - u0) / pixel_m - 0.5; }
  double row(double v) const { return color.rows - 0.5 - (v - v0) / pixel_m; }
};

}  // namespace loci::mapping
