#include "gui/data/question_answers.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "memory/questions/part_names.h"
#include "memory/questions/place_names.h"
#include "memory/questions/spoken.h"
#include "memory/questions/words.h"

namespace loci::gui {
namespace {

/// Words as a shell takes them apart: 'tea cup' and "tea cup" are one.
std::vector<std::string> shell_words(const std::string& text) {
  std::vector<std::string> words;
  bool open = false;
  char quote = 0;
  for (const char c : text) {
    if (quote != 0 ? c == quote : c == '\'' || c == '"') {
      quote = quote != 0 ? char{0} : c;
      if (!open) words.emplace_back();
      open = true;
    } else if (quote == 0 && c == ' ') {
      open = false;
    } else {
      if (!open) words.emplace_back();
      open = true;
      words.back() += c;
    }
  }
  return words;
}

/// The verbs that sentences become are those that may be typed.
bool is_verb(const std::string& word) {
  const auto& patterns = memory::sentence_patterns();
  return std::any_of(patterns.begin(), patterns.end(), [&](const memory::SentencePattern& pattern) {
    return pattern.command == word || pattern.command.starts_with(word + " ");
  });
}

std::optional<memory::CommandLine> read_command(const std::string& text) {
  std::vector<std::string> words = shell_words(text);
  if (!words.empty() && words[0] == "loci-memory") words.erase(words.begin());
  if (words.empty() || !is_verb(words[0])) return std::nullopt;
  memory::CommandLine command{.verb = words[0]};
  for (size_t i = 1; i < words.size(); ++i) {
    if (!words[i].starts_with("--")) {
      command.words.push_back(words[i]);
      continue;
    }
    const std::string name = words[i].substr(2);
    auto& values = command.options[name];
    const size_t wanted = name == "between" ? 2 : 1;
    while (values.size() < wanted && i + 1 < words.size()) values.push_back(words[++i]);
    if (values.size() < wanted) throw Error(fmt::format("--{} takes {} value(s)", name, wanted));
  }
  return command;
}

TypedAnswer answer_command(const memory::Store& store, const memory::CommandLine& command,
                           const memory::AsOf& as_of) {
  TypedAnswer answer{.command = command.text()};
  try {
    answer.text = to_text(run_question(store, command, as_of), memory::TimeWriter(store));
  } catch (const Error& error) {
    answer.text = error.message() + (error.hint().empty() ? "." : " (" + error.hint() + ").");
  }
  return answer;
}

}  // namespace

TypedAnswer answer_question(const memory::Store& store, const TypedQuestion& question) {
  const memory::AsOf as_of{.at = question.at, .known_at = {}};
  TypedAnswer answer;
  if (!understand(question.text, memory::TimeReader(store)))
    if (const auto command = read_command(question.text)) {
      answer = answer_command(store, *command, as_of);
      answer.question = question.text;
      return answer;
    }
  memory::SpokenQuestion spoken{.sentences = {}, .as_of = as_of};
  if (question.about) spoken.sentences.push_back("where is " + memory::object_name(*question.about));
  spoken.sentences.push_back(question.text);
  memory::SpokenAnswer said = ask(store, spoken).back();
  answer.question = question.text;
  answer.understood = said.command.has_value();
  if (said.command) answer.command = said.command->text();
  answer.nearest = std::move(said.nearest);
  for (const std::string& note : said.notes) answer.text += "(" + note + ")\n";
  if (said.why_not) answer.text += said.why_not->text + "\n";
  if (said.answer) answer.text += to_text(*said.answer, memory::TimeWriter(store));
  return answer;
}

std::vector<std::string> example_questions(const memory::Store& store) {
  std::vector<std::string> questions;
  const auto states = ask(store, memory::ObjectsQuestion{}).objects;
  const auto moved = ask(store, memory::ChangesQuestion{}).changes;
  const auto name = [](const memory::ObjectRef& object) {
    return object.aliases.empty() ? object.name : "the " + object.aliases.front();
  };
  if (!states.empty()) questions.push_back(fmt::format("Where is {}?", name(states.front().object)));
  for (auto change = moved.rbegin(); change != moved.rend(); ++change)
    if (change->kind == "moved" && change->object) {
      questions.push_back(fmt::format("Where has {} been?", name(*change->object)));
      break;
    }
  if (!states.empty() && states.front().place)
    questions.push_back(fmt::format("What is {} {}?", states.front().place->container ? "in" : "on",
                                    states.front().place->name));
  for (const memory::SentencePattern& pattern : memory::sentence_patterns())
    if (!pattern.example.empty()) questions.push_back(pattern.example);
  return questions;
}

std::vector<std::string> known_words(const memory::Store& store) {
  std::set<std::string> words;
  for (const memory::ObjectRow& object : store.objects()) words.insert(memory::object_name(object.id));
  for (const memory::PlaceRow& place : named_places(store)) words.insert(place.name);
  const memory::PartNames names = part_names(store);
  for (const auto* parts : {&names.links, &names.joints})
    for (const auto& [in_map, name] : *parts) words.insert(name);
  for (const memory::FactRow& fact : store.facts())
    if (fact.value && (fact.key == "alias" || fact.key == "class")) words.insert(*fact.value);
  return {words.begin(), words.end()};
}

}  // namespace loci::gui
