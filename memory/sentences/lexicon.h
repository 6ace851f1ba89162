#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace loci::memory {

// The words of the grammar: their classes and lemmas, compounds, and what changes no meaning.

using Words = std::vector<std::string>;

/// What a word can be in a sentence. Words that are none of these are names: of objects, places, properties.
enum class WordClass {
  name,
  question,   ///< "where", "howmany"
  auxiliary,  ///< "is", "did", "could"
  person,     ///< "I", "someone", "the robot"
  article,    ///< "the", "my", "any": begins a phrase
  empty,      ///< "please", "still": changes nothing
  relation,   ///< "on", "into", "of": begins a phrase
  ordinary,   ///< a word that is neither a name nor known to a rule: "tomorrow", "nice"
};

/// Lemmas by the words that stand for them: "saw" → "see".
const std::map<std::string, std::string>& lexicon();
/// The lemma of a word; a word without one is its own.
const std::string& lemma_of(const std::string& word);
/// Whether it is the lemma of other words: rules may tell it apart from others.
bool has_meaning(const std::string& lemma);
/// The class of a lemma, where it is not that of a concept of the rules.
WordClass class_of(const std::string& lemma);

/// Whether a word stands for what was named before: "it", "they", "them".
bool is_pronoun(const std::string& lemma);
/// Verbs that begin an order: "show", "bring".
bool is_order(const std::string& lemma);

/// "table", "drawers", "fridge"
bool is_furniture(const std::string& word);

/// "table", "cup", "tea"
bool is_household_noun(const std::string& word);

/// The words of a sentence in lower case, without punctuation; "what's" is "what is", "second drawer" is
/// "drawer 2". Times and names keep their ':', '-', '_' and '.'.
Words sentence_words(const std::string& sentence);

/// Contractions that no apostrophe shows, or of their own: "whats" → "what is", "can't" → "can not".
const std::map<std::string, Words>& contractions();

/// Words with their lemmas; "next to" is one word.
struct Tokens {
  Words words, lemmas;
};
Tokens tokens_of(Words words);

/// Words between blanks or brackets and bars of forms, as parts of the text, which has to outlive them.
std::vector<std::string_view> word_views(std::string_view text);
/// The words of a text, each once.
std::set<std::string> word_set(const char* words);
/// Whether all lemmas are in a set.
bool all_in(const Words& lemmas, const std::set<std::string>& set);
/// "" where compounds leave no word.
std::string first_lemma(const Words& words);
/// The first "it", else a "that" that no name follows.
std::optional<size_t> find_pronoun(const Words& words);

/// "Stayed", "remain": was there, and was so all the time.
bool is_of_staying(const std::string& word);

void replace_words(Words& words, size_t first, size_t count, const Words& by);
bool starts_with_words(const Words& words, const Words& head, size_t at = 0);
/// Words [first, last) with blanks between them.
std::string join_words(const Words& words, size_t first, size_t last);

/// Whether one edit makes one word of the other: a letter more, less or other, or two neighbours exchanged.
bool is_one_typo(std::string_view a, std::string_view b);

}  // namespace loci::memory
