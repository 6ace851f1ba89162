#pragma once

#include <set>
#include <string>
#include <vector>

#include "memory/questions/time_parser.h"
#include "memory/sentences/lexicon.h"

namespace loci::memory {

inline constexpr size_t kMaxSentenceWords = 60;

/// The words that ask, without what only surrounds them: fillers ("um"), forms of address, politeness,
/// introductions ("could you tell me whether"), tags ("isn't it"), statements before or after the question
/// ("I fancy a hot drink."). A topic takes the place of its pronoun: "The second drawer, when was it opened?"
/// Of several ways the most literal comes first; empty for no words and for more than kMaxSentenceWords.
/// `concepts` are the lemmas that rules name.
std::vector<Words> core_words(const std::string& sentence, const std::set<std::string>& concepts);

/// A piece of a sentence.
struct SentencePart {
  Words words = {};
  bool asks = false;  ///< it is a question or an order; else a statement or a name
};
/// The questions of a sentence and what is said around them, in order, without politeness. Empty where a
/// condition or a time clause restricts a question ("if the drawer is open, ..."), and for more than
/// kMaxSentenceWords.
std::vector<SentencePart> sentence_parts(const std::string& sentence, const TimeReader& times);

/// Removes politeness and introductions from both ends.
void strip_surroundings(Words& words);

/// Whether a word stands for what was named before: "it", "they", "them".
bool is_pronoun(const std::string& lemma);
/// Verbs that begin an order: "show", "bring".
bool is_order(const std::string& lemma);

}  // namespace loci::memory
