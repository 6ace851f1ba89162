#include "mapping/image/image_io.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/imgcodecs.hpp>

#include "mapping/base/error.h"
#include "mapping/base/files.h"
#include "mapping/image/image_format.h"

namespace loci::mapping {
namespace {

/// OpenCV would tell its own story on stderr beside our one line.
void silence_opencv() {
  static const auto previous = cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
  static_cast<void>(previous);
}

cv::Mat decode(std::string_view bytes, const std::string& name, int flags) {
  silence_opencv();
  require_whole_image(bytes, name);
  const cv::Mat encoded(1, static_cast<int>(bytes.size()), CV_8U, const_cast<char*>(bytes.data()));
  cv::Mat image;
  try {
    image = cv::imdecode(encoded, flags);
  } catch (const cv::Exception& error) {
    throw Error("the image cannot be decoded: " + error.err, {name, 0, {}});
  }
  if (image.empty()) throw Error("the image cannot be decoded", {name, 0, {}});
  return image;
}

std::vector<int> encoding_parameters(const std::string& ending) {
  if (ending == ".png") return {cv::IMWRITE_PNG_COMPRESSION, 3};
  if (ending == ".jpg" || ending == ".jpeg") return {cv::IMWRITE_JPEG_QUALITY, 95};
  throw Error("images are written as .png or .jpg, not '" + ending + "'");
}

}  // namespace

cv::Mat read_color(const std::filesystem::path& path) {
  return decode(read_file(path), path.string(), cv::IMREAD_COLOR | cv::IMREAD_IGNORE_ORIENTATION);
}

cv::Mat read_uint16(const std::filesystem::path& path) {
  cv::Mat image = decode(read_file(path), path.string(), cv::IMREAD_UNCHANGED);
  if (image.type() != CV_16UC1)
    throw Error("a 16-bit grey image was expected", {path.string(), 0, {}},
                "depth and labels are 16-bit PNG");
  return image;
}

ImageHeader read_image_header(const std::filesystem::path& path) {
  std::error_code code;
  const auto size = std::filesystem::file_size(path, code);
  if (code) throw Error("no such image", {path.string(), 0, {}});
  std::ifstream file(path, std::ios::binary);
  if (!file) throw Error(std::string("cannot be read: ") + std::strerror(errno), {path.string(), 0, {}});
  std::string head(std::min<size_t>(size, 1 << 16), '\0');
  file.read(head.data(), static_cast<std::streamsize>(head.size()));
  std::string tail(std::min<size_t>(size, 1 << 10), '\0');
  file.seekg(-static_cast<std::streamoff>(tail.size()), std::ios::end);
  file.read(tail.data(), static_cast<std::streamsize>(tail.size()));
  if (!file) throw Error("reading failed", {path.string(), 0, {}});
  const ImageHeader header = parse_image_header(head, path.string());
  if (!has_image_end(head, tail))
    throw Error("the image is truncated", {path.string(), 0, {}}, "copy or record the file again");
  return header;
}

void write_image(const std::filesystem::path& path, const cv::Mat& image) {
  const auto bytes = encode_image(image, path.extension().string());
  write_file_atomically(path, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

std::vector<unsigned char> encode_image(const cv::Mat& image, const std::string& ending) {
  silence_opencv();
  std::vector<unsigned char> bytes;
  bool encoded = false;
  try {
    encoded = !image.empty() && cv::imencode(ending, image, bytes, encoding_parameters(ending));
  } catch (const cv::Exception& error) {
    throw Error("the image cannot be encoded as " + ending + ": " + error.err);
  }
  if (!encoded) throw Error("the image cannot be encoded as " + ending);
  return bytes;
}

cv::Mat decode_image(const std::vector<unsigned char>& bytes, const std::string& name) {
  return decode({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, name, cv::IMREAD_UNCHANGED);
}

}  // namespace loci::mapping
