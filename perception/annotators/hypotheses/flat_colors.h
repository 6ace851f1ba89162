#pragma once

#include <opencv2/core.hpp>

namespace loci::perception {

/// What is certain by its height alone; CV_8U, of the colour image's size.
struct FlatSeeds {
  cv::Mat table;
  cv::Mat object;
};

/// Bin of each pixel of an image (CV_8UC3): saturation · bins + hue; CV_16U.
cv::Mat color_bins(const cv::Mat& color, int bins);

/// How much more likely a pixel's hue and saturation are among the object seeds than among the table seeds,
/// as a logarithm (histogram back-projection of both classes); CV_32F, within ±4. `bin_of`: color_bins().
cv::Mat color_log_odds(const cv::Mat& bin_of, const FlatSeeds& seeds, int bins);

/// The same for a height, whose error has the standard deviation `noise` (metres): surfaces are below
/// `table_m`, objects above `object_m`. Within ±3, and 0 where there is none.
cv::Mat height_log_odds(const cv::Mat& heights, double table_m, double object_m, double noise);

}  // namespace loci::perception
