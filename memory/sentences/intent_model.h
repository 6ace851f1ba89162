#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "memory/sentences/lexicon.h"

namespace loci::memory {

// A log-linear (maximum-entropy) classifier of sentences whose names are placeholders: "where did I leave
// OBJECT" means the form "Where is OBJECT?". The build trains it from paraphrases.txt.

/// The words that features are made of: placeholders, and words with a meaning. OTHER and THIRD are objects,
/// too, and SECOND is a place.
Tokens intent_tokens(const Words& words);
/// What a sentence looks like to the classifier: its words, lemmas, neighbours, and each lemma with the
/// question word.
std::vector<std::string> intent_features(const Tokens& tokens);

struct IntentSample {
  size_t form = 0;  ///< index
  Tokens tokens = {};
};

struct IntentModel {
  std::vector<std::string> forms = {};     ///< "Where is OBJECT?"; "none" asks the memory nothing
  std::vector<std::string> features = {};  ///< sorted
  std::vector<float> weights = {};         ///< by feature, then by form
  std::vector<std::string> words =
      {};  ///< by form: the lemmas of its paraphrases, sorted, with blanks around each
};

/// The maximum a posteriori weights under a Gaussian prior: the same on every run.
IntentModel train_intents(const std::vector<std::string>& forms, const std::vector<IntentSample>& samples);

/// What the build has trained.
const IntentModel& trained_intents();
/// Weights as they are stored: whole multiples of the step.
inline constexpr float kIntentWeightStep = 1.0F / 128;
IntentModel quantized_intents(std::span<const char* const> forms, std::span<const char* const> features,
                              std::span<const short> weights, std::span<const char* const> words);

/// The form of sentences that ask the memory nothing.
inline constexpr const char* kNoIntent = "none";
/// Kinds of the placeholders: "OBJECT OBJECT PLACE".
std::string placeholder_signature(const Tokens& tokens);
/// By form; "*" = any, for kNoIntent.
std::vector<std::string> signatures_of(const std::vector<std::string>& forms);

struct IntentReading {
  size_t form = 0;
  double probability = 0;  ///< among the forms that take what the sentence names
};
IntentReading best_intent(const IntentModel& model, const std::vector<std::string>& signatures,
                          const Tokens& tokens);
/// Lemmas that no paraphrase of the form has: the form may say less than the sentence.
Words uncovered_words(const IntentModel& model, size_t form, const Tokens& tokens);

/// Forms and their paraphrases, as paraphrases.txt has them. Error with the line for a paraphrase whose
/// placeholders are not those of its form.
struct Paraphrases {
  std::vector<std::string> forms = {};
  std::vector<IntentSample> samples = {};  ///< neighbours in the file stay neighbours
};
Paraphrases read_paraphrases(const std::string& text, const std::string& file);

}  // namespace loci::memory
