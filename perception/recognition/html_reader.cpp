#include "perception/recognition/html_reader.h"

#include <algorithm>
#include <cstdlib>

namespace loci::perception {
namespace {

bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\n' || c == '\r' || c == '\f';
}

std::string lower(std::string_view text) {
  std::string result(text);
  for (char& c : result)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return result;
}

std::string utf8(uint32_t code) {
  std::string bytes;
  const auto add = [&](uint32_t value) { bytes += static_cast<char>(static_cast<unsigned char>(value)); };
  if (code < 0x80) {
    add(code);
  } else if (code < 0x800) {
    add(0xc0 | code >> 6);
    add(0x80 | (code & 0x3f));
  } else if (code < 0x10000) {
    add(0xe0 | code >> 12);
    add(0x80 | (code >> 6 & 0x3f));
    add(0x80 | (code & 0x3f));
  } else {
    add(0xf0 | code >> 18);
    add(0x80 | (code >> 12 & 0x3f));
    add(0x80 | (code >> 6 & 0x3f));
    add(0x80 | (code & 0x3f));
  }
  return bytes;
}

/// What stands for &NAME;, or "" when nobody knows.
std::string entity(const std::string& name) {
  static const std::map<std::string, uint32_t> known = {
      {"amp", '&'},     {"lt", '<'},      {"gt", '>'},       {"quot", '"'},     {"apos", '\''},
      {"nbsp", ' '},    {"auml", 0xe4},   {"ouml", 0xf6},    {"uuml", 0xfc},    {"Auml", 0xc4},
      {"Ouml", 0xd6},   {"Uuml", 0xdc},   {"szlig", 0xdf},   {"eacute", 0xe9},  {"egrave", 0xe8},
      {"agrave", 0xe0}, {"aring", 0xe5},  {"Aring", 0xc5},   {"ccedil", 0xe7},  {"ntilde", 0xf1},
      {"euro", 0x20ac}, {"pound", 0xa3},  {"deg", 0xb0},     {"reg", 0xae},     {"trade", 0x2122},
      {"frac12", 0xbd}, {"frac14", 0xbc}, {"ndash", 0x2013}, {"mdash", 0x2014}, {"rsquo", 0x2019}};
  if (name.starts_with('#')) {
    const bool hex = name.size() > 1 && (name[1] == 'x' || name[1] == 'X');
    const unsigned long code = std::strtoul(name.c_str() + (hex ? 2 : 1), nullptr, hex ? 16 : 10);
    const bool sign = code >= 0x20 && code <= 0x10ffff && (code < 0xd800 || code > 0xdfff);
    return sign ? utf8(code == 0xa0 ? ' ' : static_cast<uint32_t>(code)) : " ";
  }
  const auto found = known.find(name);
  return found == known.end() ? std::string() : utf8(found->second);
}

/// Reads the attributes between `at` and the end of a tag, and returns where that ends.
size_t read_attributes(std::string_view page, size_t at, HtmlTag& tag) {
  while (at < page.size() && page[at] != '>') {
    if (is_blank(page[at]) || page[at] == '/') {
      ++at;
      continue;
    }
    const size_t begin = at;
    while (at < page.size() && !is_blank(page[at]) && page[at] != '=' && page[at] != '>') ++at;
    const std::string name = lower(page.substr(begin, at - begin));
    while (at < page.size() && is_blank(page[at])) ++at;
    std::string value;
    if (at < page.size() && page[at] == '=') {
      ++at;
      while (at < page.size() && is_blank(page[at])) ++at;
      const char quote = at < page.size() && (page[at] == '"' || page[at] == '\'') ? page[at] : '\0';
      if (quote != '\0') ++at;
      const size_t from = at;
      while (at < page.size() && (quote != '\0' ? page[at] != quote : !is_blank(page[at]) && page[at] != '>'))
        ++at;
      value = html_text(page.substr(from, at - from));
      if (quote != '\0' && at < page.size()) ++at;
    }
    if (!name.empty()) tag.attributes.emplace(name, value);
  }
  return std::min(page.size(), at + 1);
}

std::string from_latin1(std::string_view page) {
  std::string text;
  for (const char c : page) text += utf8(static_cast<unsigned char>(c));
  return text;
}

bool says_latin1(std::string_view page) {
  const std::string head = lower(page.substr(0, 4096));
  size_t at = head.find("charset=");
  if (at == std::string::npos) return false;
  at = head.find_first_not_of("\"' ", at + 8);
  const std::string name = at == std::string::npos ? std::string() : head.substr(at);
  return name.starts_with("iso-8859-1") || name.starts_with("windows-1252");
}

void read_utf8(std::string_view page, const std::function<void(const HtmlTag&)>& on_tag,
               const std::function<void(const std::string&)>& on_text) {
  for (size_t at = 0; at < page.size();) {
    if (page[at] != '<') {
      const size_t end = std::min(page.find('<', at), page.size());
      on_text(std::string(page.substr(at, end - at)));
      at = end;
      continue;
    }
    if (page.substr(at, 4) == "<!--") {
      const size_t end = page.find("-->", at + 4);
      at = end == std::string_view::npos ? page.size() : end + 3;
      continue;
    }
    HtmlTag tag;
    tag.closes = at + 1 < page.size() && page[at + 1] == '/';
    const size_t begin = at + (tag.closes ? 2 : 1);
    size_t end = begin;
    while (end < page.size() && !is_blank(page[end]) && page[end] != '>' && page[end] != '/') ++end;
    tag.name = lower(page.substr(begin, end - begin));
    at = read_attributes(page, end, tag);
    on_tag(tag);
    if (tag.closes || (tag.name != "script" && tag.name != "style")) continue;
    const std::string closing = "</" + tag.name;
    size_t stop = at;
    while (stop < page.size() && lower(page.substr(stop, closing.size())) != closing) ++stop;
    on_text(std::string(page.substr(at, stop - at)));
    at = stop;
  }
}

}  // namespace

std::string HtmlTag::attribute(const std::string& key) const {
  const auto found = attributes.find(key);
  return found == attributes.end() ? std::string() : found->second;
}

std::string html_text(std::string_view text) {
  std::string result;
  const auto add = [&](const std::string& sign) {
    const bool blank = sign.size() == 1 && is_blank(sign[0]);
    if (!blank)
      result += sign;
    else if (!result.empty() && result.back() != ' ')
      result += ' ';
  };
  for (size_t at = 0; at < text.size(); ++at) {
    const size_t end = text[at] == '&' ? text.substr(0, std::min(text.size(), at + 12)).find(';', at)
                                       : std::string_view::npos;
    const std::string sign =
        end == std::string_view::npos ? "" : entity(std::string(text.substr(at + 1, end - at - 1)));
    add(sign.empty() ? std::string(1, text[at]) : sign);
    if (!sign.empty()) at = end;
  }
  return result;
}

void read_html(std::string_view page, const std::function<void(const HtmlTag&)>& tag,
               const std::function<void(const std::string&)>& text) {
  if (!says_latin1(page)) return read_utf8(page, tag, text);
  const std::string converted = from_latin1(page);
  read_utf8(converted, tag, text);
}

}  // namespace loci::perception
