#pragma once

#include <optional>
#include <string>

#include "memory/sentences/intents/pattern.h"

namespace loci::memory {

// Sentences in plainer words, before and after the readers try them.

/// What the speaker means after all: "on the shelf, no, sorry, on the counter" is on the counter; "which pot
/// is on the table, the red one or the grey one?" is which pot. Other sentences as they are.
std::string as_meant(const std::string& sentence, const IsName& is_name);

/// A sentence said otherwise.
struct Rephrasing {
  std::string sentence = {};
  bool contrary = false;  ///< the sentence asks for the contrary: "nothing moved" is "anything moved"
};
/// For a sentence that no reader understands: common constructions in plain ones ("who keeps opening", "how
/// many of the cups are red"), without courtesy around an embedded question, people as "someone". Unset where
/// there is nothing to change.
std::optional<Rephrasing> rephrased(const std::string& sentence, const IsName& is_name);

/// "Nobody moved the pot" asks for the contrary of "did somebody move the pot", "was it anywhere but on the
/// table" for that of "did it stay on the table".
struct ContraryQuestion {
  std::string question = {};
  bool only_reading = false;  ///< the sentence must not be read without its negation
};
/// Of what nobody did, of nothing, of other places, and of negations that are to be confirmed; unset for
/// other sentences.
std::optional<ContraryQuestion> contrary_question(const std::string& sentence, const IsName& is_name);

/// "Which one has moved?", "is there any left?" ask of what was spoken of; "" = nothing was.
std::string with_choice(const std::string& question, const std::string& subject);
/// "How many of them are red?" as "how many are red?"; "" for other sentences.
std::string without_partitive(const std::string& question);
/// Whether the sentence asks which of what was spoken of: an answer about everything is none.
bool chooses(const std::string& sentence);

/// A question, and another one about the same.
struct TwoQuestions {
  std::string question = {}, more = {};
  bool elided = false;  ///< `more` is a question word only
};
/// "Was the pot moved, and when?", "is the tea back, and when was it put there?"; unset for other sentences.
std::optional<TwoQuestions> two_questions(const std::string& sentence);

}  // namespace loci::memory
