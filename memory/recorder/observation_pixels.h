#pragma once

#include <opencv2/core.hpp>
#include <span>
#include <string>
#include <vector>

#include "memory/recorder/scene_record.h"

namespace loci::memory {

/// Box of points along the axes of the map: 1st to 99th percentile, since outliers are common.
belief::AxisBox robust_box(const std::vector<Vector3d>& points);

/// PNG or JPEG, by `ending`.
std::string encoded_image(const cv::Mat& image, const std::string& ending);

/// What the pixels of an observation (row · width + column of the depth image) give: points and their box,
/// the labels of the view, the region and the mask. `record` has the view and the observations before this
/// one.
void set_pixels(std::span<const int32_t> pixels, SceneRecord& record, ObservationRecord& observation);

}  // namespace loci::memory
