#pragma once

#include <cstdint>
#include <string>

/// Protocol Buffers written by hand, from nothing but numbers and types.
namespace loci::perception::wire {

inline std::string varint(uint64_t value) {
  std::string bytes;
  for (; value >= 0x80; value >>= 7) bytes += static_cast<char>((value & 0x7f) | 0x80);
  return bytes += static_cast<char>(value);
}
inline std::string number(uint64_t field, uint64_t value) {
  return varint(field << 3) + varint(value);
}
/// Text, bytes or a message.
inline std::string text(uint64_t field, const std::string& bytes) {
  return varint(field << 3 | 2) + varint(bytes.size()) + bytes;
}
inline std::string fixed64(uint64_t field, uint64_t value) {
  std::string bytes = varint(field << 3 | 1);
  for (int i = 0; i < 8; ++i, value >>= 8) bytes += static_cast<char>(value & 0xff);
  return bytes;
}
inline std::string fixed32(uint64_t field, uint32_t value) {
  std::string bytes = varint(field << 3 | 5);
  for (int i = 0; i < 4; ++i, value >>= 8) bytes += static_cast<char>(value & 0xff);
  return bytes;
}
/// x 1, width 2, y 3, height 4.
inline std::string coords(int x, int y, int width, int height) {
  const auto value = [](int n) { return static_cast<uint64_t>(static_cast<int64_t>(n)); };
  return number(1, value(x)) + number(2, value(width)) + number(3, value(y)) + number(4, value(height));
}

inline constexpr uint64_t kUiInfo = 15690847, kSearchQuery = 15693652, kDirectResult = 16045192,
                          kStructuredCopy = 16766290, kAlternatives = 15705729, kEnableUi = 15697207,
                          kDevice = 15705794;

/// GogglesResponse.info with a title, a category and UIInfo.
inline std::string info(const std::string& title, const std::string& category, const std::string& ui) {
  return text(1, text(1, title) + text(2, category) + text(kUiInfo, ui));
}

}  // namespace loci::perception::wire
