#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <string_view>
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

/// Features, weights and words are read where the build or the training has them: a program that asks one
/// question does not copy them first.
struct IntentModel {
  std::vector<std::string> forms = {};         ///< "Where is OBJECT?"; "none" asks the memory nothing
  std::vector<std::string> signatures = {};    ///< by form, as signatures_of() has them
  std::span<const char* const> features = {};  ///< sorted
  std::span<const short> weights = {};         ///< by feature, then by form: multiples of kIntentWeightStep
  std::span<const char* const> words =
      {};  ///< by form: the lemmas of its paraphrases, with blanks around each
  std::shared_ptr<const void> storage = {};  ///< of what was trained in this process

  bool has_feature(std::string_view feature) const;
};
inline constexpr float kIntentWeightStep = 1.0F / 128;

/// The maximum a posteriori weights under a Gaussian prior: the same on every run.
IntentModel train_intents(const std::vector<std::string>& forms, const std::vector<IntentSample>& samples);

/// What the build has trained.
const IntentModel& trained_intents();

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
IntentReading best_intent(const IntentModel& model, const Tokens& tokens);
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
