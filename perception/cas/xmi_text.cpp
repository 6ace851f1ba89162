#include "perception/cas/xmi_text.h"

#include <fmt/format.h>

#include <algorithm>

namespace loci::perception::cas {
namespace {

/// Length of the character at the beginning that XML 1.0 allows; 0 when there is none.
size_t allowed_character(std::string_view text) {
  const auto byte = [&](size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned first = byte(0);
  if (first < 0x80) return first >= 0x20 || first == '\t' || first == '\n' || first == '\r' ? 1 : 0;
  const size_t length = first >= 0xc2 && first < 0xe0   ? 2
                        : first >= 0xe0 && first < 0xf0 ? 3
                        : first >= 0xf0 && first < 0xf5 ? 4
                                                        : 0;
  if (length == 0 || length > text.size()) return 0;
  uint32_t code = first & (0xffU >> (length + 1));
  for (size_t i = 1; i < length; ++i) {
    if ((byte(i) & 0xc0U) != 0x80) return 0;
    code = (code << 6) | (byte(i) & 0x3fU);
  }
  const uint32_t least = length == 2 ? 0x80 : length == 3 ? 0x800 : 0x10000;
  const bool allowed = code >= least && (code < 0xd800 || code > 0xdfff) && code != 0xfffe &&
                       code != 0xffff && code <= 0x10ffff;
  return allowed ? length : 0;
}

bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\n' || c == '\r';
}

}  // namespace

std::string xml_text(std::string_view text) {
  std::string result;
  for (size_t i = 0; i < text.size();) {
    const size_t length = allowed_character(text.substr(i));
    const char c = text[i];
    const bool outer = c == ' ' && (i == 0 || i + 1 == text.size());
    if (length == 0)
      result += "&#32;";
    else if (c == '&' || c == '<' || c == '>' || c == '"' || c == '\t' || c == '\n' || c == '\r' || outer)
      result += fmt::format("&#{};", static_cast<int>(c));
    else
      result += text.substr(i, length);
    i += std::max<size_t>(1, length);
  }
  return result;
}

bool xml_loses(std::string_view text) {
  for (size_t i = 0; i < text.size();) {
    const size_t length = allowed_character(text.substr(i));
    if (length == 0) return true;
    i += length;
  }
  return false;
}

std::string with_blanks_kept(std::string_view xml) {
  std::string result;
  size_t copied = 0;
  for (size_t close = xml.find("</"); close != std::string_view::npos; close = xml.find("</", close + 2)) {
    size_t begin = close;
    while (begin > 0 && is_blank(xml[begin - 1])) --begin;
    if (begin == close || begin == 0 || xml[begin - 1] != '>') continue;
    // Only what an element of this very name opens: <name ...>   </name>.
    const size_t open = xml.rfind('<', begin);
    const size_t length = std::min(xml.find('>', close), xml.size()) - close - 2;
    if (open == std::string_view::npos || xml[begin - 2] == '/' ||
        xml.substr(open + 1, length) != xml.substr(close + 2, length))
      continue;
    result += xml.substr(copied, begin - copied);
    for (size_t i = begin; i < close; ++i) result += fmt::format("&#{};", static_cast<int>(xml[i]));
    copied = close;
  }
  return result + std::string(xml.substr(copied));
}

}  // namespace loci::perception::cas
