#include "apps/cli/help.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "mapping/base/text/json.h"

namespace loci::apps {
namespace {

constexpr size_t kWidth = 100;    ///< columns of a help text
constexpr size_t kMaxLabel = 30;  ///< longer labels stand on a line of their own

struct Row {
  std::string label, text;
  std::string value = {};  ///< default and unit
};

/// Columns that a UTF-8 text takes, for the characters that help texts use.
size_t columns(std::string_view text) {
  return static_cast<size_t>(std::count_if(
      text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; }));
}

/// Words of `text`, then `value` in one piece, in lines of at most kWidth columns; each after the first is
/// indented.
std::string wrapped(const std::string& text, const std::string& value, size_t indent) {
  std::vector<std::string> words;
  for (size_t begin = 0; begin < text.size();) {
    const size_t end = std::min(text.find(' ', begin), text.size());
    words.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  if (!value.empty()) words.push_back(value);
  std::string result;
  size_t column = indent;
  for (const std::string& word : words) {
    const bool first = result.empty();
    const bool fits = first || column + 1 + columns(word) <= kWidth;
    if (!fits) column = indent;
    if (!first) result += fits ? " " : fmt::format("\n{:{}}", "", indent);
    result += word;
    column += columns(word) + (fits && !first ? 1 : 0);
  }
  return result;
}

/// Rows in two columns under their headings, which stand in the order of their first rows.
class Sections {
 public:
  void add(const std::string& heading, Row row) {
    auto section = std::find_if(sections_.begin(), sections_.end(),
                                [&](const auto& each) { return each.first == heading; });
    if (section == sections_.end()) section = sections_.insert(section, {heading, {}});
    section->second.push_back(std::move(row));
  }

  std::string text() const {
    size_t width = 0;
    for (const auto& [heading, rows] : sections_)
      for (const Row& row : rows)
        if (columns(row.label) <= kMaxLabel) width = std::max(width, columns(row.label));
    std::string text;
    for (const auto& [heading, rows] : sections_) {
      text += fmt::format("\n{}:\n", heading);
      for (const Row& row : rows) {
        const size_t label = columns(row.label);
        text += "  " + row.label;
        text += label > width ? fmt::format("\n{:{}}", "", width + 4) : std::string(width + 2 - label, ' ');
        text += wrapped(row.text, row.value, width + 4) + "\n";
      }
    }
    return text;
  }

 private:
  std::vector<std::pair<std::string, std::vector<Row>>> sections_;
};

std::string heading_of(const Argument& argument) {
  if (argument.positional()) return "Arguments";
  return argument.group.empty() ? "Options" : argument.group;
}

/// Description and allowed values.
std::string explanation(const Argument& argument) {
  std::string text = argument.description;
  if (text.ends_with('.')) text.pop_back();
  if (!argument.choices.empty()) text += fmt::format(" ({})", fmt::join(argument.choices, ", "));
  if (argument.required && !argument.positional()) text += " (required)";
  return text;
}

std::string usage(const std::string& name, const ArgumentTable& arguments) {
  std::string text = "Usage: " + name;
  bool options = false;
  for (const Argument& argument : arguments.all()) {
    if (argument.positional())
      text += argument.required ? " " + spelling(argument) : " [" + spelling(argument) + "]";
    else if (argument.required)
      text += fmt::format(" {} {}", argument.short_name.empty() ? argument.name : argument.short_name,
                          argument.value_name);
    else
      options = options || !argument.hidden;
  }
  return text + (options ? " [OPTIONS]\n" : "\n");
}

std::string examples_text(const std::vector<std::string>& examples) {
  return examples.empty() ? "" : fmt::format("\nExamples:\n  {}\n", fmt::join(examples, "\n  "));
}

}  // namespace

std::string program_help(const std::string& program, const std::string& description,
                         const std::vector<Command>& commands) {
  Sections sections;
  for (const Command& command : commands)
    sections.add(command.group.empty() ? "Commands" : command.group, {command.name, command.description});
  sections.add("Options",
               {"--help", "Print this help, or that of a command: " + program + " COMMAND --help"});
  sections.add("Options", {"--version", "Print the version"});
  return fmt::format("{}\n\nUsage: {} COMMAND [ARGUMENTS] [OPTIONS]\n{}", description, program,
                     sections.text());
}

std::string command_help(const std::string& name, const Command& command, const ArgumentTable& arguments) {
  Sections sections;
  for (const bool positional : {true, false})
    for (const Argument& argument : arguments.all())
      if (argument.positional() == positional && !argument.hidden)
        sections.add(heading_of(argument),
                     {spelling(argument), explanation(argument), default_text(argument)});
  return fmt::format("{}\n\n{}{}{}", command.description, usage(name, arguments), sections.text(),
                     examples_text(command.examples));
}

Json command_json(const Command& command, const ArgumentTable& arguments) {
  Json json = {{"name", command.name},
               {"group", command.group},
               {"description", command.description},
               {"examples", command.examples},
               {"arguments", Json::array()}};
  for (const Argument& argument : arguments.all()) {
    if (argument.hidden) continue;
    json["arguments"].push_back({{"name", argument.name},
                                 {"short_name", argument.short_name},
                                 {"spelling", spelling(argument)},
                                 {"value_name", argument.value_name},
                                 {"description", explanation(argument)},
                                 {"default", default_text(argument)},
                                 {"heading", heading_of(argument)},
                                 {"required", argument.required},
                                 {"list", argument.list()},
                                 {"negatable", argument.negatable},
                                 {"choices", argument.choices}});
  }
  return json;
}

}  // namespace loci::apps
