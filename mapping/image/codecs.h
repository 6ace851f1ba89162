#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "mapping/base/error.h"

namespace loci::mapping {

/// What a decoder returns: the image as it is stored, or 8-bit BGR.
enum class PixelFormat { stored, bgr };

/// Checked before memory is taken, with the size that the decoder itself read: no side may be 0.
inline void require_decodable_size(uint64_t width, uint64_t height, uint64_t max_pixels,
                                   const std::string& name) {
  if (width == 0 || height == 0 || width > max_pixels / height)
    throw Error(
        "the image is too large: " + std::to_string(width) + " x " + std::to_string(height) + " pixels",
        {name, 0, {}}, "at most " + std::to_string(max_pixels) + " pixels are read");
}

/// PNG through libpng: 8 or 16 bits per channel; palettes become colour, grey with alpha becomes BGRA, and
/// `bgr` drops alpha and the lower byte of 16 bits. Error when the bytes are damaged or the image is too
/// large; `name` is for the message.
cv::Mat decode_png(std::string_view bytes, PixelFormat format, const std::string& name, uint64_t max_pixels);
/// 8- or 16-bit image of 1, 3 or 4 channels. Same pixels, same bytes.
std::vector<unsigned char> encode_png(const cv::Mat& image);

/// JPEG through libjpeg-turbo; orientation tags are ignored, arithmetic coding is refused, and so is an image
/// of which libjpeg reports that data are missing or corrupt.
cv::Mat decode_jpeg(std::string_view bytes, PixelFormat format, const std::string& name, uint64_t max_pixels);
/// 8-bit image of 1 or 3 channels; quality 95, colour at half resolution.
std::vector<unsigned char> encode_jpeg(const cv::Mat& image);

}  // namespace loci::mapping
