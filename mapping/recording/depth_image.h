#pragma once

#include <array>
#include <cmath>
#include <filesystem>
#include <limits>
#include <opencv2/core.hpp>

namespace loci::mapping {

/// Size and kind of a depth image, from the head of its file.
struct DepthHeader {
  int width = 0;          ///< pixels
  int height = 0;         ///< pixels
  bool is_float = false;  ///< floating-point numbers, else 16-bit integers
};

/// A depth where something was measured (positive and finite), else NaN.
inline float metres_or_nan(float metres) {
  return metres > 0 && std::isfinite(metres) ? metres : std::numeric_limits<float>::quiet_NaN();
}

/// Endings of depth images, what is depth most surely first: PNG may also be a drawing of it.
inline constexpr std::array kDepthEndings = {".npy", ".exr", ".tiff", ".tif", ".png"};

/// Place of a file's ending in kDepthEndings, in upper or lower case; their number for another one.
size_t depth_ending_of(const std::filesystem::path& path);

/// The header of a file: 16-bit grey PNG, NumPy array (uint16, float16, float32, float64; C order, little
/// endian), TIFF (one channel of uint16 or float32), OpenEXR (one channel, or that named Z). The first bytes
/// say which. Error when the file is missing, of another kind or shorter than it says.
DepthHeader read_depth_header(const std::filesystem::path& path);

/// The pixels as stored: CV_16UC1 or CV_32FC1. Error as above, and when they are damaged.
cv::Mat read_depth_image(const std::filesystem::path& path);

}  // namespace loci::mapping
