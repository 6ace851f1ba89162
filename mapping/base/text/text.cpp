#include "mapping/base/text/text.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "mapping/base/error.h"
#include "mapping/base/text/json.h"

namespace loci {

std::string lower_case(std::string_view text) {
  std::string lower(text);
  for (char& c : lower)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return lower;
}

std::string upper_case(std::string_view text) {
  std::string upper(text);
  for (char& c : upper)
    if (c >= 'a' && c <= 'z') c = static_cast<char>(c - 'a' + 'A');
  return upper;
}

std::string trimmed(std::string_view text) {
  const auto begin = std::find_if_not(text.begin(), text.end(), is_space);
  const auto end = std::find_if_not(text.rbegin(), std::make_reverse_iterator(begin), is_space).base();
  return {begin, end};
}

std::vector<std::string> split(std::string_view text, char separator) {
  std::vector<std::string> parts(1);
  for (const char c : text) {
    if (c == separator)
      parts.emplace_back();
    else
      parts.back() += c;
  }
  return parts;
}

std::vector<std::string> words_of(std::string_view text) {
  return words_of(text, " \t\n\v\f\r");
}

std::vector<std::string> words_of(std::string_view text, std::string_view separators) {
  std::vector<std::string> words;
  size_t begin = text.find_first_not_of(separators);
  while (begin != std::string_view::npos) {
    const size_t end = std::min(text.find_first_of(separators, begin), text.size());
    words.emplace_back(text.substr(begin, end - begin));
    begin = text.find_first_not_of(separators, end);
  }
  return words;
}

std::string joined(const std::vector<std::string>& parts, std::string_view separator) {
  return fmt::format("{}", fmt::join(parts, separator));
}

namespace {

/// "boxes", "bodies", "shelves", "knives", "days".
std::string plural_of(std::string_view noun) {
  const auto replaced = [&](size_t letters, const char* by) {
    return std::string(noun.substr(0, noun.size() - letters)) + by;
  };
  const bool after_vowel =
      noun.size() > 1 && std::string_view("aeiou").find(noun[noun.size() - 2]) != std::string_view::npos;
  if (noun.ends_with('y') && !after_vowel) return replaced(1, "ies");
  if (noun.ends_with("lf")) return replaced(1, "ves");
  if (noun.ends_with("ife")) return replaced(2, "ves");
  for (const char* hiss : {"s", "x", "z", "ch", "sh"})
    if (noun.ends_with(hiss)) return replaced(0, "es");
  return replaced(0, "s");
}

}  // namespace

std::string counted(size_t count, std::string_view noun) {
  return fmt::format("{} {}", count, count == 1 ? std::string(noun) : plural_of(noun));
}

bool is_utf8(const std::string& text) {
  try {
    static_cast<void>(Json(text).dump());
  } catch (const Json::type_error&) {
    return false;
  }
  return true;
}

void require_utf8(const std::string& text) {
  if (!is_utf8(text))
    throw Error(Json(text).dump(-1, ' ', false, Json::error_handler_t::replace) + " is not UTF-8");
}

}  // namespace loci
