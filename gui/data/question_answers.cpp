#include "gui/data/question_answers.h"

#include <fmt/format.h>

#include "memory/questions/forgotten.h"
#include "memory/sentences/natural_language.h"
#include "memory/sentences/sentence_parser.h"

namespace loci::gui {
namespace {

std::string text_of(const memory::NaturalLanguageAnswer& answer, const memory::TimeWriter& times) {
  std::string text;
  for (const std::string& note : answer.notes) text += "(" + note + ")\n";
  if (answer.why_not && !answer.reply) text += answer.why_not->text + "\n";
  if (answer.reply) text += answer.reply->text + "\n";
  if (answer.answer) text += answer.answer->to_text(times);
  return text;
}

}  // namespace

TypedAnswer answer_question(const memory::Store& store, const TypedQuestion& question) {
  const memory::AsOf as_of{.at = question.at, .known_at = {}};
  const memory::TimeWriter times(store);
  TypedAnswer typed{.question = question.text};
  if (!memory::parse_sentence(question.text, memory::TimeReader(store))) {
    try {
      if (const auto query = memory::parse_query(question.text)) {
        typed.command = query->text();
        typed.text = memory::ask(store, *query, as_of).to_text(times);
        if (const auto forgotten = memory::forgotten_time(store, *query, as_of); forgotten && forgotten->all)
          typed.text.insert(
              0, fmt::format("Not observed: {}.\n", memory::forgotten_text(forgotten->period, times)));
        return typed;
      }
    } catch (const Error& error) {
      typed.text = error.message() + (error.hint().empty() ? "." : " (" + error.hint() + ").");
      return typed;
    }
  }
  const memory::NaturalLanguageAnswer answer =
      ask(store, memory::NaturalLanguageQuestion{{question.text}, as_of, question.about}).front();
  if (answer.query) typed.command = answer.query->text();
  typed.nearest = answer.nearest;
  typed.text = text_of(answer, times);
  return typed;
}

}  // namespace loci::gui
