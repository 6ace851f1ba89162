// Answers to sentences as text and as JSON.

#include <fmt/format.h>

#include "mapping/base/text/json.h"
#include "memory/questions/replies/answer_fields.h"
#include "memory/sentences/natural_language.h"

namespace loci::memory {

using namespace format;

std::string to_text(const NaturalLanguageAnswer& answer, const TimeWriter& times, bool details) {
  std::string text;
  if (details && answer.query) text += "= loci-memory " + answer.query->text() + "\n";
  if (!answer.understood_as.empty()) text += answer.understood_as + "\n";
  if (answer.reply) text += answer.reply->text + "\n";
  if (answer.why_not && !answer.reply) text += answer.why_not->text + "\n";
  std::vector<std::string> lines = answer.notes;
  for (std::string& note : lines) note = fmt::format("({})", note);
  if (answer.why_not && !answer.why_not->hint.empty()) lines.push_back(answer.why_not->hint);
  if (answer.reply && !details)
    lines.insert(lines.end(), answer.reply->evidence.begin(), answer.reply->evidence.end());
  const size_t lines_left = kMaxEvidenceLines - (answer.understood_as.empty() ? 0 : 1);
  if (!details && lines.size() > lines_left) lines.resize(lines_left);
  for (const std::string& line : lines) text += "  " + line + "\n";
  if (!answer.nearest.empty()) text += "What is understood, for example:\n";
  for (const std::string& sentence : answer.nearest) text += "  " + sentence + "\n";
  return text + (details && answer.answer ? answer.answer->to_text(times) : "");
}

namespace {

const Record<NoAnswer>& no_answer_record() {
  static const auto record =
      Record<NoAnswer>("NoAnswer")
          .value("reason", &NoAnswer::reason)
          .value("text", &NoAnswer::text)
          .value("hint", [](const NoAnswer& answer) { return unless_empty(answer.hint); });
  return record;
}

const Record<NaturalLanguageAnswer>& sentence_record() {
  using Sentence = NaturalLanguageAnswer;
  static const auto record =
      Record<Sentence>("SentenceAnswer")
          .value("sentence", &Sentence::sentence)
          .value("understood", [](const Sentence& answer) { return answer.query.has_value(); })
          .value("command",
                 [](const Sentence& answer) {
                   return answer.query ? std::optional(answer.query->text()) : std::nullopt;
                 })
          .value("understood_as", [](const Sentence& answer) { return unless_empty(answer.understood_as); })
          .value("notes", [](const Sentence& answer) { return unless_empty(answer.notes); })
          .record("reply", &Sentence::reply, reply_record())
          .value("answer",
                 [](const Sentence& answer) {
                   return answer.answer ? std::optional(answer.answer->to_json()) : std::nullopt;
                 })
          .record("why_not", &Sentence::why_not, no_answer_record())
          .value("nearest", [](const Sentence& answer) { return unless_empty(answer.nearest); });
  return record;
}

}  // namespace

Json to_json(const NaturalLanguageAnswer& answer) {
  return sentence_record().json(answer);
}

const RecordSchema& sentence_schema() {
  return sentence_record();
}

}  // namespace loci::memory
