#pragma once

#include <map>
#include <string>
#include <vector>

namespace loci::memory {

// The words of the grammar: inflected words and their lemmas, compounds, and what changes no meaning.

using Words = std::vector<std::string>;

/// Lemmas by the words that stand for them: "saw" → "see".
const std::map<std::string, std::string>& lexicon();
/// Whether a word changes nothing: "the", "please", "still".
bool is_empty_word(const std::string& word);
/// Whether no phrase for an object, a place or a time has this word: "where", "is", "you".
bool is_closed_word(const std::string& word);

/// The words of a sentence in lower case, without punctuation; "what's" is "what is", "second drawer" is
/// "drawer 2". Times and names keep their ':', '-', '_' and '.'.
Words sentence_words(const std::string& sentence);

/// Words with their lemmas; "next to" is one word.
struct Tokens {
  Words words, lemmas;
};
Tokens tokens_of(Words words);

void replace_words(Words& words, size_t first, size_t count, const Words& by);
bool starts_with_words(const Words& words, const Words& head, size_t at = 0);

/// Whether one edit makes one word of the other: a letter more, less or other, or two neighbours exchanged.
bool is_one_typo(const std::string& a, const std::string& b);

}  // namespace loci::memory
