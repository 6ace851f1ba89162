// The only file that includes CLI11, which takes seconds to compile.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <stdexcept>

#include "apps/cli/arguments.h"

namespace loci::apps {
namespace {

CLI::Option* declare(CLI::App& app, const Argument& argument) {
  const std::string names =
      argument.short_name.empty() ? argument.name : argument.short_name + "," + argument.name;
  if (argument.flag())
    return app.add_flag(argument.negatable ? names + ",!--no-" + argument.name.substr(2) : names);
  CLI::Option* option = app.add_option(names);
  const bool open_end = argument.open_end || (argument.positional() && argument.list());
  const int values = argument.list() ? argument.values : 1;
  option->expected(values, open_end ? CLI::detail::expected_max_vector_size : values);
  option->allow_extra_args(open_end);
  option->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  option->type_name(argument.value_name);
  return option;
}

[[noreturn]] void refuse_unknown(const std::string& word, const ArgumentTable& arguments) {
  const bool option =
      word.size() > 1 && word[0] == '-' && std::isdigit(static_cast<unsigned char>(word[1])) == 0;
  if (!option) throw UsageError(fmt::format("unexpected argument '{}'", word));
  std::vector<std::string> names = {"--help", "--version"};
  for (const Argument& argument : arguments.all())
    if (!argument.hidden) names.push_back(argument.name);
  throw unknown("option", word.substr(0, word.find('=')), names);
}

}  // namespace

void ArgumentTable::parse(const std::vector<std::string>& words) const {
  CLI::App app;
  app.set_help_flag();
  app.allow_extras();
  std::vector<CLI::Option*> parsed;
  for (const Argument& argument : arguments_) parsed.push_back(declare(app, argument));
  std::vector<std::string> reversed(words.rbegin(), words.rend());
  try {
    app.parse(reversed);
  } catch (const CLI::ArgumentMismatch& error) {
    const std::string text = error.what(), name = text.substr(0, text.find(':'));
    const Argument* argument = find(name);
    throw UsageError(argument != nullptr && argument->values > 1
                         ? fmt::format("{} needs {} values", name, argument->values)
                         : name + " needs a value");
  } catch (const CLI::ParseError& error) {
    throw UsageError(error.what());
  }
  for (const std::string& word : app.remaining()) refuse_unknown(word, *this);
  const auto given = [&](const std::string& name) {
    const Argument* argument = find(name);
    if (argument == nullptr) throw std::logic_error("undeclared argument " + name);
    return parsed[static_cast<size_t>(argument - arguments_.data())]->count() > 0;
  };
  for (size_t i = 0; i < arguments_.size(); ++i) {
    const Argument& argument = arguments_[i];
    const std::vector<std::string>& texts = parsed[i]->results();
    if (argument.given != nullptr) *argument.given = !texts.empty();
    // As of a variable of the shell that is not set: what the argument names would be left out in silence.
    if (!argument.flag() && !(argument.positional() && argument.list()) &&
        std::ranges::any_of(texts, [](const std::string& text) { return text.empty(); }))
      throw UsageError(argument.name + " is empty");
    if (texts.empty()) {
      if (argument.required) throw UsageError(argument.name + " is required");
      continue;
    }
    const size_t values = argument.list() ? static_cast<size_t>(argument.values) : 1;
    if (texts.size() < values) throw UsageError(fmt::format("{} needs {} values", argument.name, values));
    if (texts.size() > values && !argument.flag() && (values > 1 || !argument.list()))
      throw UsageError(argument.name + " is given several times");
    for (const std::string& other : argument.needs)
      if (!given(other)) throw UsageError(fmt::format("{} needs {}", argument.name, other));
    for (const std::string& other : argument.excludes)
      if (given(other)) throw UsageError(fmt::format("{} and {} exclude each other", argument.name, other));
    set_value(argument, texts);
  }
}

}  // namespace loci::apps
