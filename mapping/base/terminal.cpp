#include "mapping/base/terminal.h"

#include <fmt/format.h>

#include <cstdint>

namespace loci {
namespace {

struct CodePoint {
  uint32_t value = 0;
  size_t bytes = 0;  ///< 0: the text does not begin with UTF-8
};

CodePoint first_of(std::string_view text) {
  const auto byte = [&](size_t i) { return static_cast<uint8_t>(text[i]); };
  const uint8_t lead = byte(0);
  if (lead < 0x80) return {lead, 1};
  const size_t bytes = lead >= 0xF0 ? 4 : lead >= 0xE0 ? 3 : 2;
  if (lead < 0xC2 || lead > 0xF4 || text.size() < bytes) return {};
  uint32_t value = lead & (0xFFU >> (bytes + 1));
  for (size_t i = 1; i < bytes; ++i) {
    if ((byte(i) & 0xC0) != 0x80) return {};
    value = value << 6 | (byte(i) & 0x3FU);
  }
  constexpr uint32_t kMinThree = 0x800, kMinFour = 0x10000, kMax = 0x10FFFF;
  const bool overlong = (bytes == 3 && value < kMinThree) || (bytes == 4 && value < kMinFour);
  const bool surrogate = value >= 0xD800 && value <= 0xDFFF;
  return overlong || surrogate || value > kMax ? CodePoint{} : CodePoint{value, bytes};
}

/// C0, DEL, C1, line and paragraph separators, and the marks that change the direction of text.
bool steers(uint32_t c) {
  if (c < 0x20) return c != '\n' && c != '\t';
  return (c >= 0x7F && c < 0xA0) || c == 0x061C || c == 0x200E || c == 0x200F ||
         (c >= 0x2028 && c <= 0x202E) || (c >= 0x2066 && c <= 0x2069);
}

}  // namespace

std::string terminal_text(std::string_view text) {
  std::string result;
  result.reserve(text.size());
  while (!text.empty()) {
    const CodePoint point = first_of(text);
    if (point.bytes == 0)
      result += fmt::format("\\x{:02x}", static_cast<uint8_t>(text[0]));
    else if (steers(point.value))
      result += fmt::format("\\u{:04x}", point.value);
    else
      result += text.substr(0, point.bytes);
    text.remove_prefix(point.bytes == 0 ? 1 : point.bytes);
  }
  return result;
}

}  // namespace loci
