#pragma once

#include <cstdint>
#include <filesystem>
#include <opencv2/core.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace loci::mapping {

/// No camera takes more; larger images are refused before memory is taken.
inline constexpr uint64_t kMaxImagePixels = uint64_t{1} << 27;

/// A colour image (CV_8UC3, BGR) from PNG or JPEG. Error when it is missing, truncated or not an image.
cv::Mat read_color(const std::filesystem::path& path);

/// A 16-bit image (CV_16UC1) from PNG: raw depth or labels. Error when it is missing, truncated or of
/// another kind.
cv::Mat read_uint16(const std::filesystem::path& path);

/// Size and kind of an image, from the head of its file.
struct ImageHeader {
  int width = 0;     ///< pixels
  int height = 0;    ///< pixels
  int channels = 0;  ///< 1 grey, 2 grey and alpha, 3 colour, 4 colour and alpha
  int bits = 0;      ///< per channel
};

/// The header from the first bytes of a PNG or JPEG. Error when it is neither.
ImageHeader parse_image_header(std::string_view head, const std::string& name);

/// The header of a file, without decoding it. Error when the file is missing, not an image, or its end is
/// missing (reads head and tail only).
ImageHeader read_image_header(const std::filesystem::path& path);

/// Writes PNG or JPEG by the file's ending, atomically; same pixels, same bytes.
void write_image(const std::filesystem::path& path, const cv::Mat& image);

/// In memory, for blobs: ".png" (8 or 16 bits; 1, 3 or 4 channels) or ".jpg" (8 bits; 1 or 3 channels).
std::vector<unsigned char> encode_image(const cv::Mat& image, const std::string& ending);
/// Depth and channels as stored. Error when the bytes are not a whole PNG or JPEG image; `name` is for the
/// message.
cv::Mat decode_image(const std::vector<unsigned char>& bytes, const std::string& name);
/// A colour image (CV_8UC3, BGR) of at most `max_pixels`, which is checked before memory is taken.
cv::Mat decode_color(std::string_view bytes, const std::string& name, uint64_t max_pixels = kMaxImagePixels);

}  // namespace loci::mapping
