// Generates completions, manual pages and the reference in docs/ from what a program prints with
// --describe-cli:
//   loci_cli_reference FOLDER PROGRAM...
// writes FOLDER/{bash-completion/completions, zsh/site-functions, man/man1, doc/loci}.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "apps/cli/program.h"
#include "mapping/base/files.h"
#include "mapping/base/text/json.h"

namespace loci::apps {
namespace {

namespace fs = std::filesystem;

using Texts = std::vector<std::string>;

std::string text_of(const Json& json, const char* key) {
  return json.at(key).get<std::string>();
}

std::string replaced(const std::string& text, const std::string& what, const std::string& with) {
  std::string result;
  size_t begin = 0;
  for (size_t at = text.find(what); at != text.npos; at = text.find(what, begin)) {
    result.append(text, begin, at - begin).append(with);
    begin = at + what.size();
  }
  return result.append(text, begin);
}

/// What the program prints with --describe-cli.
Json description_of(const fs::path& program) {
  const std::string command = "'" + program.string() + "' --describe-cli";
  std::FILE* pipe = popen(command.c_str(), "r");
  if (pipe == nullptr) throw Error("cannot be run", {program.string(), 0, {}});
  std::string output;
  std::array<char, 1 << 14> buffer{};
  while (const size_t count = std::fread(buffer.data(), 1, buffer.size(), pipe))
    output.append(buffer.data(), count);
  if (pclose(pipe) != 0) throw Error("--describe-cli failed", {program.string(), 0, {}});
  return parse_json(output, program.string());
}

bool positional(const Json& argument) {
  return !text_of(argument, "name").starts_with('-');
}

/// Every spelling of an option: "--output", "-o", "--no-compare".
Texts spellings(const Json& argument) {
  Texts words = {text_of(argument, "name")};
  if (const std::string name = text_of(argument, "short_name"); !name.empty()) words.push_back(name);
  if (argument.at("negatable").get<bool>()) words.push_back("--no-" + words[0].substr(2));
  return words;
}

// Manual pages

/// Text in which troff finds no commands.
std::string troff(const std::string& text) {
  const std::string escaped = replaced(replaced(text, "\\", "\\e"), "-", "\\-");
  return escaped.starts_with('.') || escaped.starts_with('\'') ? "\\&" + escaped : escaped;
}

/// Heading, name and the beginning of the synopsis. `name` is "loci-map fuse", its page loci-map-fuse.
std::string page_head(const Json& program, const std::string& name, const std::string& description) {
  const std::string page = replaced(name, " ", "-");
  return fmt::format(
      ".TH {} 1 \"\" \"loci {}\" \"User Commands\"\n.SH NAME\n{} \\- {}\n.SH SYNOPSIS\n.B {}\n", troff(page),
      text_of(program, "version"), troff(page), troff(description), troff(name));
}

std::string page_tail(const Texts& references) {
  std::string text =
      ".SH EXIT STATUS\n0 on success, 1 on an error, 2 on wrong usage, 130 when interrupted.\n.SH SEE ALSO\n";
  for (const std::string& page : references)
    text += fmt::format(".BR {} (1){}\n", troff(page), page == references.back() ? "" : ",");
  return text;
}

std::string synopsis(const Json& command) {
  std::string text;
  for (const Json& argument : command.at("arguments")) {
    const bool required = argument.at("required").get<bool>();
    const std::string spelling = troff(text_of(argument, "spelling"));
    if (positional(argument))
      text += (required ? ".I " + spelling : ".RI [ " + spelling + " ]") + "\n";
    else if (required)
      text +=
          ".B " + troff(text_of(argument, "name")) + "\n.I " + troff(text_of(argument, "value_name")) + "\n";
  }
  return text + ".RI [ OPTIONS ]\n";
}

std::string command_page(const Json& program, const Json& command) {
  const std::string name = text_of(program, "program"), own = text_of(command, "name");
  const std::string description = text_of(command, "description");
  std::string text =
      page_head(program, own.empty() ? name : name + " " + own, description) + synopsis(command);
  text += ".SH DESCRIPTION\n" + troff(description) + ".\n";
  Texts headings;
  for (const Json& argument : command.at("arguments"))
    if (const std::string heading = text_of(argument, "heading");
        std::find(headings.begin(), headings.end(), heading) == headings.end())
      headings.push_back(heading);
  for (const std::string& heading : headings) {
    text += ".SH \"" + troff(heading) + "\"\n";
    for (const Json& argument : command.at("arguments"))
      if (text_of(argument, "heading") == heading)
        text += fmt::format(".TP\n.B {}\n{}\n", troff(text_of(argument, "spelling")),
                            troff(text_of(argument, "description") + " " + text_of(argument, "default")));
  }
  text += ".SH EXAMPLES\n.nf\n";
  for (const Json& example : command.at("examples")) text += troff(example.get<std::string>()) + "\n";
  return text + ".fi\n" + page_tail({own.empty() ? "loci" : name});
}

std::string program_page(const Json& program) {
  const std::string name = text_of(program, "program"), description = text_of(program, "description");
  std::string text = page_head(program, name, description) +
                     ".I COMMAND\n.RI [ ARGUMENTS ]\n.RI [ OPTIONS ]\n.SH DESCRIPTION\n" +
                     troff(description) + ".\n.SH COMMANDS\n";
  Texts references;
  if (name != "loci") references.push_back("loci");
  for (const Json& command : program.at("commands")) {
    const std::string own = text_of(command, "name");
    text += fmt::format(".TP\n.B {}\n{}\n", troff(own), troff(text_of(command, "description")));
    references.push_back(fmt::format("{}-{}", name, own));
  }
  return text + page_tail(references);
}

// Markdown

/// Text in a cell of a table.
std::string cell(const std::string& text) {
  return replaced(replaced(text, "|", "\\|"), "<", "&lt;");
}

/// The arguments of a command under one heading, as a table; nothing without any.
std::string argument_table(const Json& command, const std::string& heading) {
  std::string rows;
  for (const Json& argument : command.at("arguments")) {
    if (text_of(argument, "heading") != heading) continue;
    rows += fmt::format("| `{}` | {} | {} |\n", replaced(text_of(argument, "spelling"), "|", "\\|"),
                        cell(text_of(argument, "description")), cell(text_of(argument, "default")));
  }
  return rows.empty() ? rows : fmt::format("| {} | | |\n|---|---|---|\n{}\n", heading, rows);
}

/// The reference of a program: its commands with arguments, options, defaults and examples. Options that
/// every command has stand once, at the end.
std::string reference_page(const Json& program) {
  const std::string name = text_of(program, "program"), common = "Common options";
  std::string text = fmt::format("# {}\n\n{}. Generated from the declarations behind `{} --help`.\n\n", name,
                                 text_of(program, "description"), name);
  for (const Json& command : program.at("commands")) {
    const std::string own = text_of(command, "name");
    if (!own.empty()) text += fmt::format("## {} {}\n\n", name, own);
    text += text_of(command, "description") + ".\n\n";
    Texts headings;
    for (const Json& argument : command.at("arguments"))
      if (const std::string heading = text_of(argument, "heading");
          heading != common && std::find(headings.begin(), headings.end(), heading) == headings.end())
        headings.push_back(heading);
    for (const std::string& heading : headings) text += argument_table(command, heading);
    for (const Json& example : command.at("examples"))
      text += fmt::format("    {}\n", example.get<std::string>());
    text += '\n';
  }
  return text + "## " + common + "\n\n" + argument_table(program.at("commands").front(), common);
}

// Completions

/// Text in single quotes of a shell.
std::string shell_word(const std::string& text) {
  return fmt::format("'{}'", replaced(text, "'", "'\\''"));
}

/// Whether the value of an argument may be the name of a file.
bool may_be_file(const Json& argument) {
  static const Texts kOthers = {"N", "NUMBER", "TIME", "DURATION", "POSE", "QUESTION"};
  return std::find(kOthers.begin(), kOthers.end(), text_of(argument, "value_name")) == kOthers.end();
}

std::string choices_of(const Json& argument) {
  return fmt::format("{}", fmt::join(argument.at("choices").get<Texts>(), " "));
}

/// Completes from the tables of a program; its command stands at position `at`, 0 of a program without
/// commands.
constexpr const char* kBashComplete = R"(_loci_complete() {
  local -n options=$1_options values=$1_values words=$1_words
  local at=$2 cur=${COMP_WORDS[COMP_CWORD]} prev=${COMP_WORDS[COMP_CWORD-1]} command=-
  (( at > 0 )) && command=${COMP_WORDS[at]}
  [[ $cur == = ]] && cur=
  [[ $prev == = ]] && prev=${COMP_WORDS[COMP_CWORD-2]}
  COMPREPLY=()
  if (( at > 0 && COMP_CWORD == at )); then
    COMPREPLY=($(compgen -W "${!options[*]} --help --version" -- "$cur"))
  elif [[ -n ${values["$command $prev"]+set} ]]; then
    COMPREPLY=($(compgen -W "${values["$command $prev"]}" -- "$cur"))
    compopt +o default 2>/dev/null
  elif [[ $cur == -* ]]; then
    COMPREPLY=($(compgen -W "${options["$command"]-}" -- "$cur"))
  elif (( COMP_CWORD == at + 1 )) && [[ -n ${words["$command"]-} ]]; then
    COMPREPLY=($(compgen -W "${words["$command"]}" -- "$cur"))
  fi
}
)";

std::string bash_completion(const Json& program) {
  const std::string name = text_of(program, "program"), function = "_" + replaced(name, "-", "_");
  std::string options, values, words;
  bool alone = false;
  for (const Json& command : program.at("commands")) {
    std::string key = text_of(command, "name");
    alone = key.empty();
    if (alone) key = "-";
    Texts names;
    for (const Json& argument : command.at("arguments")) {
      const std::string choices = choices_of(argument);
      if (positional(argument)) {
        if (!choices.empty()) words += fmt::format("  [{}]={}\n", shell_word(key), shell_word(choices));
        continue;
      }
      for (const std::string& spelling : spellings(argument)) {
        names.push_back(spelling);
        if (!text_of(argument, "value_name").empty() && (!choices.empty() || !may_be_file(argument)))
          values += fmt::format("  [{}]={}\n", shell_word(fmt::format("{} {}", key, spelling)),
                                shell_word(choices));
      }
    }
    options +=
        fmt::format("  [{}]={}\n", shell_word(key), shell_word(fmt::format("{}", fmt::join(names, " "))));
  }
  std::string text = fmt::format("# Completion of {} in bash.\n{}", name, kBashComplete);
  for (const auto& [table, rows] : {std::pair("options", &options), {"values", &values}, {"words", &words}})
    text += fmt::format("declare -gA {}_{}=(\n{})\n", function, table, *rows);
  return text +
         fmt::format("{0}_at={1}\n{0}() {{ _loci_complete {0} {1}; }}\ncomplete -o default -F {0} {2}\n",
                     function, alone ? 0 : 1, name);
}

/// Of the dispatcher: programs first, then what the program completes.
std::string bash_dispatcher(const Json& program) {
  Texts names;
  for (const Json& each : program.at("commands")) names.push_back(text_of(each, "name"));
  return fmt::format(R"(# Completion of loci in bash.
_loci() {{
  local program=${{COMP_WORDS[1]}} at=2 folder=${{BASH_SOURCE[0]%/*}}
  COMPREPLY=()
  if [[ $program == help ]] && (( COMP_CWORD > 1 )); then
    program=${{COMP_WORDS[2]}} at=3
  fi
  if (( COMP_CWORD < at )); then
    COMPREPLY=($(compgen -W "{} help version" -- "${{COMP_WORDS[COMP_CWORD]}}"))
  elif declare -F "_loci_$program" >/dev/null || . "$folder/loci-$program" 2>/dev/null; then
    local own=_loci_${{program}}_at
    (( ${{!own}} == 0 )) && at=0
    _loci_complete "_loci_$program" "$at"
  fi
}}
complete -o default -F _loci loci
)",
                     fmt::join(names, " "));
}

/// A description inside a specification of zsh's _arguments.
std::string zsh_text(std::string text) {
  for (const char* special : {"\\", "[", "]", ":"})
    text = replaced(text, special, fmt::format("\\{}", special));
  return text;
}

std::string zsh_arguments(const Json& command) {
  std::string text;
  for (const Json& argument : command.at("arguments")) {
    const std::string value = text_of(argument, "value_name"), choices = choices_of(argument);
    std::string action = value.empty() ? "" : fmt::format(":{}:", zsh_text(value));
    if (!action.empty())
      action += !choices.empty() ? fmt::format("({})", choices) : may_be_file(argument) ? "_files" : "";
    const bool list = argument.at("list").get<bool>();
    if (positional(argument)) {
      text.append(" ").append(shell_word((list ? "*" : ":") + action));
      continue;
    }
    for (const std::string& spelling : spellings(argument))
      text.append(" ").append(shell_word(fmt::format("{}{}[{}]{}", list ? "*" : "", spelling,
                                                     zsh_text(text_of(argument, "description")), action)));
  }
  return "_arguments" + text;
}

std::string zsh_completion(const Json& program) {
  const std::string name = text_of(program, "program");
  std::string commands, cases;
  for (const Json& command : program.at("commands")) {
    const std::string own = text_of(command, "name");
    if (own.empty()) return "#compdef " + name + "\n" + zsh_arguments(command) + "\n";
    commands += fmt::format("  {}\n", shell_word(own + ":" + text_of(command, "description")));
    cases += fmt::format("  {}) {} ;;\n", own, zsh_arguments(command));
  }
  if (program.contains("dispatcher")) cases = "  *) words[1]=loci-$command; _normal ;;\n";
  return fmt::format(
      "#compdef {}\nlocal -a commands=(\n{})\nif (( CURRENT == 2 )); then\n  _describe command commands\n  "
      "return\nfi\n"
      "local command=$words[2]\nshift words\n(( CURRENT-- ))\ncase $command in\n{}esac\n",
      name, commands, cases);
}

void generate(const fs::path& program, const fs::path& folder) {
  const Json json = description_of(program);
  const std::string name = text_of(json, "program");
  const bool dispatcher = json.contains("dispatcher");
  const fs::path bash = folder / "bash-completion/completions", zsh = folder / "zsh/site-functions",
                 man = folder / "man/man1", doc = folder / "doc/loci";
  for (const fs::path& each : {bash, zsh, man, doc}) make_folder(each);
  write_file_atomically(bash / name, dispatcher ? bash_dispatcher(json) : bash_completion(json));
  write_file_atomically(zsh / ("_" + name), zsh_completion(json));
  const bool alone = text_of(json.at("commands")[0], "name").empty();
  write_file_atomically(man / (name + ".1"),
                        alone ? command_page(json, json.at("commands")[0]) : program_page(json));
  if (!dispatcher) write_file_atomically(doc / (name + ".md"), reference_page(json));
  if (dispatcher || alone) return;
  for (const Json& command : json.at("commands"))
    write_file_atomically(man / (name + "-" + text_of(command, "name") + ".1"), command_page(json, command));
}

}  // namespace
}  // namespace loci::apps

int main(int argc, char** argv) {
  return loci::apps::run_guarded("loci_cli_reference", [&] {
    if (argc < 3) throw loci::apps::UsageError("FOLDER and PROGRAM... are required");
    for (int i = 2; i < argc; ++i) loci::apps::generate(argv[i], argv[1]);
    return 0;
  });
}
