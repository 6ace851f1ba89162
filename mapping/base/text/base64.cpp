#include "mapping/base/text/base64.h"

#include <array>
#include <cstdint>

#include "mapping/base/error.h"

namespace loci {

namespace {

constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

std::array<int8_t, 256> digit_values() {
  std::array<int8_t, 256> values;
  values.fill(-1);
  for (size_t i = 0; i < kDigits.size(); ++i)
    values[static_cast<uint8_t>(kDigits[i])] = static_cast<int8_t>(i);
  return values;
}

}  // namespace

std::string base64_from_bytes(std::string_view bytes) {
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (size_t i = 0; i < bytes.size(); i += 3) {
    const size_t left = std::min<size_t>(3, bytes.size() - i);
    uint32_t group = 0;
    for (size_t k = 0; k < 3; ++k) group = group << 8 | (k < left ? static_cast<uint8_t>(bytes[i + k]) : 0U);
    for (size_t k = 0; k < 4; ++k) text += k <= left ? kDigits[group >> (18 - 6 * k) & 63U] : '=';
  }
  return text;
}

std::string base64_from_bytes(std::span<const unsigned char> bytes) {
  return base64_from_bytes(std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
}

std::string bytes_from_base64(std::string_view text) {
  static const std::array<int8_t, 256> values = digit_values();
  const Error broken("not base64 text");
  if (text.size() % 4 != 0) throw broken;
  size_t padding = 0;
  while (padding < 2 && padding < text.size() && text[text.size() - 1 - padding] == '=') ++padding;
  std::string bytes;
  bytes.reserve(text.size() / 4 * 3);
  for (size_t i = 0; i < text.size(); i += 4) {
    uint32_t group = 0;
    for (size_t k = 0; k < 4; ++k) {
      const bool padded = i + k >= text.size() - padding;
      const int8_t value = padded ? int8_t{0} : values[static_cast<uint8_t>(text[i + k])];
      if (value < 0) throw broken;
      group = group << 6 | static_cast<uint32_t>(value);
    }
    for (size_t k = 0; k < 3; ++k) bytes += static_cast<char>(group >> (16 - 8 * k) & 255U);
  }
  return bytes.substr(0, text.size() / 4 * 3 - padding);
}

}  // namespace loci
