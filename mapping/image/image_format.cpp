#include "mapping/image/image_format.h"

#include <algorithm>
#include <array>
#include <cstdint>

#include "mapping/base/error.h"

namespace loci::mapping {
namespace {

constexpr std::string_view kPngSignature("\x89PNG\r\n\x1a\n", 8);
constexpr std::string_view kJpegStart("\xff\xd8\xff", 3);
constexpr std::string_view kJpegEnd("\xff\xd9", 2);

uint8_t byte_at(std::string_view bytes, size_t at) {
  return static_cast<uint8_t>(bytes[at]);
}

uint32_t big_endian_32(std::string_view bytes, size_t at) {
  return uint32_t{byte_at(bytes, at)} << 24 | uint32_t{byte_at(bytes, at + 1)} << 16 |
         uint32_t{byte_at(bytes, at + 2)} << 8 | uint32_t{byte_at(bytes, at + 3)};
}

size_t big_endian_16(std::string_view bytes, size_t at) {
  return static_cast<size_t>(byte_at(bytes, at)) << 8 | byte_at(bytes, at + 1);
}

std::array<uint32_t, 256> crc_table() {
  std::array<uint32_t, 256> table{};
  for (uint32_t n = 0; n < table.size(); ++n) {
    uint32_t c = n;
    for (int k = 0; k < 8; ++k) c = (c & 1) != 0 ? 0xedb88320U ^ (c >> 1) : c >> 1;
    table[n] = c;
  }
  return table;
}

/// CRC-32 of PNG chunks (ISO 3309).
uint32_t crc32(std::string_view bytes) {
  static const std::array<uint32_t, 256> table = crc_table();
  uint32_t c = 0xffffffffU;
  for (const char byte : bytes) c = table[(c ^ static_cast<uint8_t>(byte)) & 0xff] ^ (c >> 8);
  return ~c;
}

Error truncated(const std::string& name) {
  return Error("the image is truncated", {name, 0, {}}, "copy or record the file again");
}

void require_whole_png(std::string_view bytes, const std::string& name) {
  size_t at = kPngSignature.size();
  while (at + 12 <= bytes.size()) {
    const size_t length = big_endian_32(bytes, at);
    if (length > bytes.size() - at - 12) throw truncated(name);
    const std::string_view type_and_data = bytes.substr(at + 4, length + 4);
    if (crc32(type_and_data) != big_endian_32(bytes, at + 8 + length))
      throw Error("the image is damaged (check sum)", {name, 0, {}}, "copy or record the file again");
    if (type_and_data.substr(0, 4) == "IEND") return;
    at += length + 12;
  }
  throw truncated(name);
}

ImageHeader parse_png_header(std::string_view head, const std::string& name) {
  if (head.size() < 26 || head.substr(12, 4) != "IHDR") throw truncated(name);
  constexpr std::array<int, 7> channels = {1, 0, 3, 3, 2, 0, 4};  // By PNG colour type; 3 is a palette.
  const size_t color_type = byte_at(head, 25);
  if (color_type >= channels.size() || channels[color_type] == 0)
    throw Error("the image has an unknown PNG colour type", {name, 0, {}});
  return {static_cast<int>(big_endian_32(head, 16)), static_cast<int>(big_endian_32(head, 20)),
          channels[color_type], color_type == 3 ? 8 : byte_at(head, 24)};
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
      return {static_cast<int>(big_endian_16(head, at + 7)), static_cast<int>(big_endian_16(head, at + 5)),
              at + 10 < head.size() ? byte_at(head, at + 9) : 3, byte_at(head, at + 4)};
    at += 2 + big_endian_16(head, at + 2);
  }
  throw truncated(name);
}

/// Some cameras pad JPEG files behind the end marker. (An end marker far from the end may be a thumbnail's.)
bool ends_as_jpeg(std::string_view bytes) {
  constexpr size_t padding = 1024;
  const std::string_view tail = bytes.size() > padding ? bytes.substr(bytes.size() - padding) : bytes;
  return tail.rfind(kJpegEnd) != std::string_view::npos;
}

}  // namespace

void require_whole_image(std::string_view bytes, const std::string& name) {
  if (bytes.starts_with(kPngSignature))
    require_whole_png(bytes, name);
  else if (!bytes.starts_with(kJpegStart))
    throw Error(bytes.empty() ? "the image is empty" : "not a PNG or JPEG image", {name, 0, {}});
  else if (!ends_as_jpeg(bytes))
    throw truncated(name);
}

ImageHeader parse_image_header(std::string_view head, const std::string& name) {
  if (head.starts_with(kPngSignature)) return parse_png_header(head, name);
  if (head.starts_with(kJpegStart)) return parse_jpeg_header(head, name);
  throw Error(head.empty() ? "the image is empty" : "not a PNG or JPEG image", {name, 0, {}});
}

bool has_image_end(std::string_view head, std::string_view tail) {
  if (head.starts_with(kPngSignature)) return tail.find("IEND\xae\x42\x60\x82") != std::string_view::npos;
  return ends_as_jpeg(tail);
}

}  // namespace loci::mapping
