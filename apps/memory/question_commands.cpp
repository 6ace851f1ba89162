// The questions of memory/questions as commands, and those that are asked in words.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <sstream>

#include "apps/memory/commands.h"
#include "apps/memory/memory_arguments.h"
#include "mapping/base/output_file.h"
#include "mapping/base/text/json.h"
#include "mapping/base/text/text.h"
#include "memory/questions/routines/digest.h"
#include "memory/questions/snapshot.h"
#include "memory/reasoning/why.h"
#include "memory/report/digest_page.h"
#include "memory/sentences/natural_language.h"

namespace loci::apps {
namespace {

constexpr const char* kDetails = "Print all that is known, not only the answer";
constexpr size_t kMaxListed = 10;  ///< lines of what a question that inspects finds

/// The first lines of a text, and how many there are more.
std::string first_lines(const std::string& text) {
  std::string first;
  size_t count = 0;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line); ++count)
    if (count < kMaxListed) first += line + "\n";
  if (count > kMaxListed)
    first += fmt::format("... {} with --details\n", counted(count - kMaxListed, "more line"));
  return first;
}

/// What is given on the command line for a question.
struct QuestionArguments {
  std::string memory;
  bool details = false;
  std::vector<std::string> words, between;
  std::map<std::string, std::string> options;  // by name of the parameter
  std::map<std::string, bool> given;           // of these

  void declare(const memory::Question& question, ArgumentTable& table);
  memory::Query query(const memory::Question& question) const;
};

void QuestionArguments::declare(const memory::Question& question, ArgumentTable& table) {
  table.memory(memory);
  bool positional = false;
  const std::vector<memory::Parameter> parameters = question.all_parameters();
  for (const memory::Parameter& parameter : parameters) {
    if (parameter.positional) {
      std::string spec = question.read_words == nullptr ? upper_case(parameter.name) : "WORD";
      spec = parameter.required ? fmt::format("{}...", spec) : fmt::format("[{}...]", spec);
      if (!positional)
        table.positional(spec, &words, question.words_help.empty() ? parameter.help : question.words_help,
                         {.default_text = parameter.default_text, .first_words = parameter.choices});
      positional = true;
      continue;
    }
    ArgumentDetails with{.default_text = parameter.default_text, .choices = parameter.choices};
    with.given = &given[parameter.name];
    if (parameter.name == "from" || parameter.name == "to") with.excludes = {"--between"};
    for (const memory::Parameter& other : parameters)
      if (std::ranges::count(parameter.excludes, other.name) > 0)
        with.excludes.push_back(other.positional ? upper_case(other.name) : "--" + other.name);
    table.option(fmt::format("--{} {}", parameter.name, upper_case(to_text(parameter.type))),
                 &options[parameter.name], parameter.help, with);
  }
  if (question.period) table.option("--between TIME TIME", &between, "Two times", {.values = 2});
  table.flag("--details", details, kDetails);
}

memory::Query QuestionArguments::query(const memory::Question& question) const {
  memory::Query query{.question = question.name, .asks = question.asks};
  for (const auto& [name, value] : options)
    if (given.at(name)) query.arguments[name] = value;
  if (!between.empty()) query.arguments["from"] = between.at(0);
  if (!between.empty()) query.arguments["to"] = between.at(1);
  question.read(words, query);
  return query;
}

/// The answer as people read it: one sentence with its evidence, and of a question that inspects the memory
/// the first lines of what it finds.
std::string text_of(const memory::Reply& reply, const memory::Answer& answer,
                    const memory::Question& question, bool details, const memory::Store& store) {
  const memory::TimeWriter times(store);
  if (details) return full_text(reply, answer, times);
  if (question.group == memory::QuestionGroup::ask) return to_text(reply);
  return headed(reply, first_lines(answer.to_text(times)));
}

Command question_command(const memory::Question& question) {
  std::vector<std::string> examples;
  for (const std::string& example : question.examples)
    examples.push_back(fmt::format("loci-memory {}{}{} -m demo-output/memory.loci", question.name,
                                   example.empty() ? "" : " ", example));
  return {.name = question.name,
          .description = question.description,
          .examples = examples,
          .declare =
              [question](ArgumentTable& table) {
                auto arguments = std::make_shared<QuestionArguments>();
                arguments->declare(question, table);
                return [arguments, question](Session& session) {
                  const memory::Store store = open_memory(arguments->memory, session);
                  const memory::Query query = arguments->query(question);
                  const memory::Answer answer = question.ask(store, query);
                  const memory::Reply reply = question.reply(store, query, answer);
                  session.answer(text_of(reply, answer, question, arguments->details, store),
                                 full_json(reply, answer));
                };
              },
          .group = to_text(question.group)};
}

/// `digest` as any question, and as a page.
Command digest_command() {
  const memory::Question& question = *memory::find_question("digest");
  Command command = question_command(question);
  command.examples.push_back("loci-memory digest -m demo-output/memory.loci -o demo-output/digest.html");
  command.declare = [&question](ArgumentTable& table) {
    struct Digest {
      QuestionArguments question;
      std::string page;
    };
    auto arguments = std::make_shared<Digest>();
    arguments->question.declare(question, table);
    table.option("-o,--output FILE", &arguments->page,
                 "Also write it as a self-contained HTML page with images", {.replaces = true});
    return [arguments, &question](Session& session) {
      if (!arguments->page.empty()) check_output(arguments->page, session.outputs());
      const memory::Store store = open_memory(arguments->question.memory, session);
      const memory::Query query = arguments->question.query(question);
      const memory::Answer answer = question.ask(store, query);
      if (!arguments->page.empty())
        write_output(arguments->page, digest_page(store, answer.get<memory::DigestAnswer>()),
                     session.outputs());
      const memory::Reply reply = question.reply(store, query, answer);
      session.answer(text_of(reply, answer, question, arguments->question.details, store),
                     full_json(reply, answer));
    };
  };
  return command;
}

/// The number in "scene_12"; unset for other words.
std::optional<memory::Id> scene_id(const std::string& name) {
  constexpr std::string_view kPrefix = "scene_";
  if (!name.starts_with(kPrefix)) return std::nullopt;
  memory::Id id = 0;
  const char* end = name.data() + name.size();
  const auto [rest, error] = std::from_chars(name.data() + kPrefix.size(), end, id);
  return error == std::errc() && rest == end ? std::optional(id) : std::nullopt;
}

struct WhyAnswer {
  memory::Why why;
};
std::string to_text(const WhyAnswer& answer, const memory::TimeWriter&) {
  return answer.why.text;
}
Json to_json(const WhyAnswer& answer) {
  return answer.why.json;
}

memory::Question why_question() {
  return {.name = "why",
          .description = "Explains a decision: evidence, alternatives, and what excluded them",
          .parameters = {{.name = "subject",
                          .type = memory::ParameterType::object,
                          .help = "scene_12, object_12, or words for an object",
                          .positional = true,
                          .required = true}},
          .examples = {"red", "scene_3 --json"},
          .answer = nullptr,
          .run = [](const memory::Arguments& given) -> memory::Answer {
            const std::string subject = given.text("subject");
            if (const std::optional<memory::Id> scene = scene_id(subject))
              return WhyAnswer{memory::why_scene(given.store(), *scene)};
            const auto objects = memory::Snapshot(given.store(), given.as_of()).find_objects(subject);
            return WhyAnswer{memory::why_object(given.store(), objects.front(), given.as_of())};
          }};
}

namespace {

/// What is asked: the words of a sentence may be given without quotes.
std::vector<std::string> sentences_of(const std::vector<std::string>& words) {
  const bool one = std::ranges::none_of(
      words, [](const std::string& word) { return word.find(' ') != std::string::npos; });
  return one ? std::vector{joined(words, " ")} : words;
}

}  // namespace

Command ask_command() {
  return {.name = "ask",
          .description = "Answers questions and tasks in English",
          .examples =
              {"loci-memory ask \"Is there anything on the couch table?\" -m demo-output/memory.loci",
               "loci-memory ask \"Where did I leave the red cup?\" \"When was the last time you saw it?\" "
               "-m demo-output/memory.loci --json"},
          .declare =
              [](ArgumentTable& table) {
                struct Arguments {
                  MemoryArguments memory;
                  std::vector<std::string> sentences;
                  bool details = false;
                };
                auto arguments = std::make_shared<Arguments>();
                arguments->memory.declare(table);
                table.positional("QUESTION...", &arguments->sentences,
                                 "A question or a task; of several, \"it\" is what the one before was about");
                table.flag("--details", arguments->details, kDetails);
                return [arguments](Session& session) {
                  const memory::Store store = open_memory(arguments->memory.memory, session);
                  const auto answers =
                      ask(store, memory::NaturalLanguageQuestion{sentences_of(arguments->sentences),
                                                                 arguments->memory.as_of(store)});
                  std::string text;
                  Json json = Json::array();
                  for (const memory::NaturalLanguageAnswer& answer : answers) {
                    text += (text.empty() ? "" : "\n") +
                            to_text(answer, memory::TimeWriter(store), arguments->details);
                    json.push_back(to_json(answer));
                  }
                  session.answer(text, json.size() == 1 ? json[0] : Json{{"answers", json}});
                  for (const memory::NaturalLanguageAnswer& answer : answers)
                    if (!answer.query)
                      throw Error("'" + answer.sentence + "' is not understood", {},
                                  "ask for example: " + answer.nearest.at(0));
                };
              },
          .group = to_text(memory::QuestionGroup::ask)};
}

Command questions_command() {
  return {.name = "questions",
          .description = "Lists the questions with their arguments and sentences",
          .examples = {"loci-memory questions", "loci-memory questions --json"},
          .declare =
              [](ArgumentTable&) {
                return [](Session& session) {
                  session.answer(memory::questions_reference(), memory::questions_json());
                };
              },
          .group = to_text(memory::QuestionGroup::ask)};
}

}  // namespace

void add_question_commands(Program& program) {
  program.add(ask_command());
  for (const memory::Question& question : memory::questions())
    program.add(question.name == "digest" ? digest_command() : question_command(question));
  program.add(question_command(why_question()));
  program.add(questions_command());
}

}  // namespace loci::apps
