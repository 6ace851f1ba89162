#pragma once

#include <optional>
#include <string>
#include <vector>

#include "memory/questions/question.h"

namespace loci::memory {

// Questions and tasks in English, by the sentence forms of the declared questions.

/// The query that a sentence means; unset when no form matches. Times are cut out first, wherever they stand:
/// "this morning", "between nine and ten", "since 9:00", "two hours ago".
std::optional<Query> parse_sentence(const std::string& sentence, const TimeReader& times);

/// Examples of the forms nearest to a sentence, nearest first.
std::vector<std::string> nearest_examples(const std::string& sentence, size_t count = 3);

/// Sentences, one after the other: "it" is what the one before was about.
struct NaturalLanguageQuestion {
  std::vector<std::string> sentences = {};
  AsOf as_of = {};               ///< `at` holds for sentences without a time
  std::optional<Id> about = {};  ///< what "it" means at first; unset = the object seen last
};

/// Why there is no answer.
struct NoAnswer {
  std::string reason = {};  ///< not_understood, never_seen, not_yet_seen, unknown_place, not_possible
  std::string text = {};
};
struct NaturalLanguageAnswer {
  std::string sentence = {};
  std::optional<Query> query = {};      ///< unset = not understood
  std::vector<std::string> notes = {};  ///< how words were interpreted
  std::optional<Answer> answer = {};
  std::optional<NoAnswer> why_not = {};   ///< set where there is no answer
  std::vector<std::string> nearest = {};  ///< sentences that are understood, when this one is not
};
/// One answer per sentence; a sentence without an answer is no error.
std::vector<NaturalLanguageAnswer> ask(const Store& store, const NaturalLanguageQuestion& question);
std::string to_text(const NaturalLanguageAnswer& answer, const TimeWriter& times);
Json to_json(const NaturalLanguageAnswer& answer);

/// Questions to suggest for this memory: about its objects first, then an example of each form.
std::vector<std::string> suggested_questions(const Store& store);
/// Names of objects, places and parts, with aliases and classes: the words to complete in a question.
std::vector<std::string> known_names(const Store& store);

}  // namespace loci::memory
