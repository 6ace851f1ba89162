#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "memory/questions/time_parser.h"
#include "memory/sentences/lexicon.h"

namespace loci::memory {

inline constexpr size_t kMaxSentenceWords = 60;

/// The words that ask, without what only surrounds them: fillers ("um"), forms of address, politeness,
/// introductions ("could you tell me whether"), tags ("isn't it"), statements that name nothing ("We have
/// guests tonight."). A topic takes the place of its pronoun: "The second drawer, when was it opened?" Of
/// several ways the most literal comes first; empty for no words and for more than kMaxSentenceWords.
/// `concepts` are the lemmas that rules name.
std::vector<Words> core_words(const std::string& sentence, const std::set<std::string>& concepts,
                              const TimeReader& times);

/// A question, and what is said before it in sentences of its own: "I had my tea here. Where is it?"
struct QuestionInContext {
  std::vector<std::string> statements = {};
  std::string question = {};
};
/// Sentences are those of a text, or of a transcript without punctuation. Unset where only one is said, or
/// more than the last one asks.
std::optional<QuestionInContext> question_in_context(const std::string& text, const TimeReader& times);

/// The question at the moment that the statements name, or of what changed since, where it names no time: "I
/// came home at six. What was on the table?", "I laid the table at six. What is missing now?" Unset where
/// they name none, or several.
std::optional<std::string> question_at_statements(const QuestionInContext& context,
                                                  const std::string& question, const TimeReader& times);

/// A text without what only fills it: "um", "uh".
std::string without_sounds(const std::string& text);

/// A piece of a sentence.
struct SentencePart {
  Words words = {};
  bool asks = false;  ///< it is a question or an order; else a statement or a name
};
/// The questions of a sentence and what is said around them, in order, without politeness. Empty where a
/// condition or a time clause restricts a question ("if the drawer is open, ..."), and for more than
/// kMaxSentenceWords.
std::vector<SentencePart> sentence_parts(const std::string& sentence, const TimeReader& times);

}  // namespace loci::memory
