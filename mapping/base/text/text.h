#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace loci {

/// ASCII letters only; other bytes (UTF-8) stay.
std::string lower_case(std::string_view text);
std::string upper_case(std::string_view text);

/// Blank, tab, line feed, carriage return, form feed, vertical tab.
constexpr bool is_space(char c) {
  return c == ' ' || (c >= '\t' && c <= '\r');
}
constexpr bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

/// Without leading and trailing space.
std::string trimmed(std::string_view text);

/// The parts between separators, empty ones included: "a,,b" → "a", "", "b"; "" → "".
std::vector<std::string> split(std::string_view text, char separator);

/// Words between runs of space, or of other separators.
std::vector<std::string> words_of(std::string_view text);
std::vector<std::string> words_of(std::string_view text, std::string_view separators);

std::string joined(const std::vector<std::string>& parts, std::string_view separator);

/// "1 scene", "3 scenes".
std::string counted(size_t count, std::string_view noun);

bool is_utf8(const std::string& text);

/// Error when a text that people gave is not UTF-8: it could not be written as JSON.
void require_utf8(const std::string& text);

}  // namespace loci
