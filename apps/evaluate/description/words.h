#pragma once

#include <set>
#include <string>

namespace loci::apps::description_evaluation {

/// In lower case, letters and digits alone: how printed words are compared.
inline std::string folded(const std::string& word) {
  std::string result;
  for (size_t i = 0; i < word.size(); ++i) {
    char c = word[i];
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    // Capital letters of Latin-1 in UTF-8 (À to Þ) are C3 80 to C3 9E.
    const auto byte = static_cast<unsigned char>(c);
    const bool capital = i > 0 && word[i - 1] == '\xc3' && byte <= 0x9e && byte >= 0x80;
    if (capital) c = static_cast<char>(byte + 0x20);
    const bool plain = (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9');
    if (plain || static_cast<unsigned char>(c) >= 0x80) result += c;
  }
  return result;
}

/// The folded words of a text or name ("God-Morgon Juice").
inline std::set<std::string> folded_words(const std::string& text) {
  std::set<std::string> words;
  std::string word;
  for (const char c : text + " ") {
    if (c != ' ' && c != '-' && c != '_' && c != '|' && c != '\n') {
      word += c;
      continue;
    }
    if (const std::string one = folded(word); !one.empty()) words.insert(one);
    word.clear();
  }
  return words;
}

}  // namespace loci::apps::description_evaluation
