#pragma once

#include <optional>
#include <string>
#include <vector>

#include "memory/questions/question.h"
#include "memory/questions/replies/reply.h"

namespace loci::memory {

// Questions and tasks in English, by the rules of the declared questions (sentence_parser.h).

/// Sentences, one after the other: "it" is what the one before was about.
struct NaturalLanguageQuestion {
  std::vector<std::string> sentences = {};
  AsOf as_of = {};               ///< `at` holds for sentences without a time
  std::optional<Id> about = {};  ///< what "it" means at first; unset = nothing
};

/// Why there is no answer.
struct NoAnswer {
  std::string reason = {};  ///< not_understood, never_seen, not_yet_seen, unknown_place, not_possible
  std::string text = {};    ///< one sentence
  std::string hint = {};    ///< what may be meant instead
};
struct NaturalLanguageAnswer {
  std::string sentence = {};
  std::optional<Query> query = {};  ///< unset = not understood; of several questions the first
  std::string understood_as = {};   ///< the questions in plain words, where they are not those that were said
  std::vector<std::string> notes = {};  ///< how words were interpreted
  std::optional<Answer> answer = {};
  std::optional<Reply> reply = {};        ///< of the answer
  std::optional<NoAnswer> why_not = {};   ///< set where there is no answer
  std::vector<std::string> nearest = {};  ///< sentences that are understood, when this one is not
};
/// One answer per sentence; a sentence without an answer is no error.
std::vector<NaturalLanguageAnswer> ask(const Store& store, const NaturalLanguageQuestion& question);
/// The reply and its evidence; with `details` the command and the whole answer.
std::string to_text(const NaturalLanguageAnswer& answer, const TimeWriter& times, bool details = false);
Json to_json(const NaturalLanguageAnswer& answer);
/// How it is written as JSON.
const format::RecordSchema& sentence_schema();

}  // namespace loci::memory
