#pragma once

#include <filesystem>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

namespace loci::mapping {

/// A colour image (CV_8UC3, BGR) from PNG or JPEG. Error when it is missing, truncated or not an image.
cv::Mat read_color(const std::filesystem::path& path);

/// A 16-bit image (CV_16UC1) from PNG: raw depth or labels. Error when it is missing, truncated or of
/// another kind.
cv::Mat read_uint16(const std::filesystem::path& path);

/// What the head of an image's file says.
struct ImageHeader {
  int width = 0;     ///< pixels
  int height = 0;    ///< pixels
  int channels = 0;  ///< 1 grey, 2 grey and alpha, 3 colour, 4 colour and alpha
  int bits = 0;      ///< per channel
};

/// Size and kind of a PNG or JPEG, without decoding it. Error when it is missing, no image, or when its end
/// is not there (cheap: head and tail are read).
ImageHeader read_image_header(const std::filesystem::path& path);

/// Writes PNG or JPEG by the file's ending, atomically; same pixels, same bytes.
void write_image(const std::filesystem::path& path, const cv::Mat& image);

/// In memory, for blobs: ".png" or ".jpg".
std::vector<unsigned char> encode_image(const cv::Mat& image, const std::string& ending);
/// Any depth and number of channels as stored. Error when the bytes are no whole image; `name` is for the
/// message.
cv::Mat decode_image(const std::vector<unsigned char>& bytes, const std::string& name);

}  // namespace loci::mapping
