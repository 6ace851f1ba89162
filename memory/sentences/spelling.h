#pragma once

#include <set>
#include <string>
#include <vector>

namespace loci::memory {

/// A sentence as it may have been meant.
struct Respelling {
  std::string sentence = {};
  std::vector<std::string> notes = {};  ///< "'tabel' is taken as 'table'"
};

/// The sentence with every word that nobody knows replaced by a word that is one typo away: first by words of
/// the grammar and of households, then by `names`, the words that a memory has for its objects and places.
/// The most likely sentence comes first; the sentence as it is where no word is to be replaced, and last
/// where one may be. `of_rare_words`: English words that the grammar does not know, too, where letters were
/// exchanged, doubled or not doubled: "ceratin", "bigest".
std::vector<Respelling> respellings(const std::string& sentence, const std::set<std::string>& names,
                                    bool of_rare_words = false);

/// Whether a word is one of the grammar, of times or of households, in the singular or plural.
bool is_known_word(const std::string& word);

}  // namespace loci::memory
