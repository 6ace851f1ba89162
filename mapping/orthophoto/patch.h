#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "mapping/orthophoto/orthophoto.h"

namespace loci::mapping {

/// What stands out in a layer before a face: places on it, and on each of its sides, pixels of the layer.
struct LayerPatch {
  std::vector<cv::Point> own;
  std::vector<std::vector<cv::Point>> sides;
};

/// Share of the single frames that show a patch of a layer there: of those that see it and all its sides,
/// those in which it differs from each side as it does in the layer. A median over changing sets of frames
/// shows edges and stripes that none of them has. 0 when no frame sees all of it.
double share_showing(const Orthophoto& photo, const PhotoLayer& layer, const LayerPatch& patch);

}  // namespace loci::mapping
