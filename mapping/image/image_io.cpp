#include "mapping/image/image_io.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>

#include "mapping/base/error.h"
#include "mapping/base/files.h"
#include "mapping/image/codecs.h"

namespace loci::mapping {
namespace {

constexpr std::string_view kPngSignature("\x89PNG\r\n\x1a\n", 8);
constexpr std::string_view kJpegStart("\xff\xd8\xff", 3);
constexpr std::string_view kJpegEnd("\xff\xd9", 2);

uint8_t byte_at(std::string_view bytes, size_t at) {
  return static_cast<uint8_t>(bytes[at]);
}

int big_endian_16(std::string_view bytes, size_t at) {
  return byte_at(bytes, at) << 8 | byte_at(bytes, at + 1);
}

int big_endian_32(std::string_view bytes, size_t at) {
  return static_cast<int>(static_cast<uint32_t>(big_endian_16(bytes, at)) << 16 |
                          static_cast<uint32_t>(big_endian_16(bytes, at + 2)));
}

Error truncated(const std::string& name) {
  return Error("the image is truncated", {name, 0, {}}, "copy or record the file again");
}

Error not_an_image(std::string_view bytes, const std::string& name) {
  return Error(bytes.empty() ? "the image is empty" : "not a PNG or JPEG image", {name, 0, {}});
}

ImageHeader parse_png_header(std::string_view head, const std::string& name) {
  if (head.size() < 26 || head.substr(12, 4) != "IHDR") throw truncated(name);
  constexpr std::array<int, 7> channels = {1, 0, 3, 3, 2, 0, 4};  // By PNG colour type; 3 is a palette.
  const size_t color_type = byte_at(head, 25);
  if (color_type >= channels.size() || channels[color_type] == 0)
    throw Error("the image has an unknown PNG colour type", {name, 0, {}});
  return {big_endian_32(head, 16), big_endian_32(head, 20), channels[color_type],
          color_type == 3 ? 8 : byte_at(head, 24)};
}

ImageHeader parse_jpeg_header(std::string_view head, const std::string& name) {
  size_t at = 2;
  while (at + 9 < head.size() && byte_at(head, at) == 0xff) {
    const int marker = byte_at(head, at + 1);
    if (marker == 0xff) {  // Fill bytes may stand before a marker.
      ++at;
      continue;
    }
    const bool frame = marker >= 0xc0 && marker <= 0xcf && marker != 0xc4 && marker != 0xc8 && marker != 0xcc;
    if (frame)
      return {big_endian_16(head, at + 7), big_endian_16(head, at + 5), byte_at(head, at + 9),
              byte_at(head, at + 4)};
    at += 2 + static_cast<size_t>(big_endian_16(head, at + 2));
  }
  throw truncated(name);
}

/// Whether the last bytes of a file are the end of an image of the kind that its first bytes announce. Some
/// cameras pad JPEG files behind the end marker; an end marker far from the end may be a thumbnail's.
bool has_image_end(std::string_view head, std::string_view tail) {
  const std::string_view end =
      head.starts_with(kPngSignature) ? std::string_view("IEND\xae\x42\x60\x82") : kJpegEnd;
  return tail.find(end) != std::string_view::npos;
}

cv::Mat decode(std::string_view bytes, const std::string& name, PixelFormat format,
               uint64_t max_pixels = kMaxImagePixels) {
  if (bytes.starts_with(kPngSignature)) return decode_png(bytes, format, name, max_pixels);
  if (bytes.starts_with(kJpegStart)) return decode_jpeg(bytes, format, name, max_pixels);
  throw not_an_image(bytes, name);
}

}  // namespace

ImageHeader parse_image_header(std::string_view head, const std::string& name) {
  if (head.starts_with(kPngSignature)) return parse_png_header(head, name);
  if (head.starts_with(kJpegStart)) return parse_jpeg_header(head, name);
  throw not_an_image(head, name);
}

cv::Mat read_color(const std::filesystem::path& path) {
  return decode(read_file(path), path.string(), PixelFormat::bgr);
}

cv::Mat read_uint16(const std::filesystem::path& path) {
  cv::Mat image = decode(read_file(path), path.string(), PixelFormat::stored);
  if (image.type() != CV_16UC1)
    throw Error("a 16-bit grey image was expected", {path.string(), 0, {}},
                "depth and labels are 16-bit PNG");
  return image;
}

ImageHeader read_image_header(const std::filesystem::path& path) {
  std::error_code code;
  const auto size = std::filesystem::file_size(path, code);
  if (code == std::errc::no_such_file_or_directory) throw Error("no such image", {path.string(), 0, {}});
  require_regular_file(path);
  std::ifstream file(path, std::ios::binary);
  if (!file) throw Error(std::string("cannot be read: ") + std::strerror(errno), {path.string(), 0, {}});
  std::string head(std::min<size_t>(size, 1 << 16), '\0');
  file.read(head.data(), static_cast<std::streamsize>(head.size()));
  std::string tail(std::min<size_t>(size, 1 << 10), '\0');
  file.seekg(-static_cast<std::streamoff>(tail.size()), std::ios::end);
  file.read(tail.data(), static_cast<std::streamsize>(tail.size()));
  if (!file) throw Error("reading failed", {path.string(), 0, {}});
  const ImageHeader header = parse_image_header(head, path.string());
  if (!has_image_end(head, tail)) throw truncated(path.string());
  return header;
}

void write_image(const std::filesystem::path& path, const cv::Mat& image) {
  const auto bytes = encode_image(image, path.extension().string());
  write_file_atomically(path, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

std::vector<unsigned char> encode_image(const cv::Mat& image, const std::string& ending) {
  if (ending == ".png") return encode_png(image);
  if (ending == ".jpg" || ending == ".jpeg") return encode_jpeg(image);
  throw Error("images are written as .png or .jpg, not '" + ending + "'");
}

cv::Mat decode_image(const std::vector<unsigned char>& bytes, const std::string& name) {
  return decode({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, name, PixelFormat::stored);
}

cv::Mat decode_color(std::string_view bytes, const std::string& name, uint64_t max_pixels) {
  return decode(bytes, name, PixelFormat::bgr, max_pixels);
}

}  // namespace loci::mapping
