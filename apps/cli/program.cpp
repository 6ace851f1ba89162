#include "apps/cli/program.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <malloc.h>
#include <stdio_ext.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "apps/cli/aside.h"
#include "apps/cli/help.h"
#include "mapping/base/files.h"
#include "mapping/base/output_file.h"
#include "mapping/base/terminal.h"
#include "mapping/base/text/json.h"

namespace loci::apps {
namespace {

constexpr const char* kOutput = "--output";

volatile std::sig_atomic_t interrupt_requested = 0;

void on_interrupt(int) {
  interrupt_requested = 1;
}

/// Images are allocated and freed with every frame: freed memory is reused instead of returned to the system,
/// which would have to clear it again page by page (a seventh of the time of a frame).
void keep_freed_memory() {
  mallopt(M_MMAP_THRESHOLD, 32 << 20);
  mallopt(M_TRIM_THRESHOLD, 256 << 20);
}

/// What every command takes; of a program without commands only help and version.
void declare_common(ArgumentTable& arguments, CommonFlags& flags, bool alone) {
  static bool ignored = false;  // read before parsing
  arguments.begin_group("");
  if (std::ranges::any_of(arguments.all(), &Argument::replaces))
    arguments.flag("--force", flags.force, "Replace an output that loci did not write");
  arguments.begin_group("Common options");
  arguments.flag("-h,--help", ignored, "Print this help");
  arguments.flag("--version", ignored, "Print the version");
  if (alone) return;
  arguments.flag("--json", flags.json, "Print the answer as JSON");
  arguments.flag("--quiet", flags.quiet, "Print no progress and no warnings");
  arguments.flag("--verbose", flags.verbose, "Print every warning");
  arguments.flag("--timing", flags.timing, "Print the time of each stage");
  arguments.option("--threads N", &flags.threads, "Number of threads, 0 for all cores",
                   {.min = 0, .max = 1024});
}

/// What an argument names, if it is text.
std::vector<std::filesystem::path> paths_of(const Argument& argument) {
  if (const auto* text = std::get_if<std::string*>(&argument.variable)) return {**text};
  if (const auto* path = std::get_if<std::filesystem::path*>(&argument.variable)) return {**path};
  if (const auto* texts = std::get_if<std::vector<std::string>*>(&argument.variable))
    return {(*texts)->begin(), (*texts)->end()};
  if (const auto* paths = std::get_if<std::vector<std::filesystem::path>*>(&argument.variable))
    return **paths;
  return {};
}

/// Whether what was done so far is kept, and the same command with --resume goes on with it.
bool can_resume(const ArgumentTable& arguments) {
  const auto resumes = [](const Argument& argument) { return argument.name == "--resume"; };
  const auto is_missing = [](const Argument& argument) {
    return argument.value_name == "MEMORY" && paths_of(argument).front().empty();
  };
  return std::ranges::any_of(arguments.all(), resumes) && std::ranges::none_of(arguments.all(), is_missing);
}

bool is_output(const Argument& argument) {
  return argument.replaces || argument.name == kOutput;
}

/// Whether a file is in SQLite's format.
bool is_memory(const std::filesystem::path& file) {
  std::array<char, 16> head{};
  std::ifstream(file, std::ios::binary).read(head.data(), head.size());
  return std::string_view(head.data(), head.size()).starts_with("SQLite format 3");
}

/// What else the command line names and exists is an input.
OutputOptions output_options(const ArgumentTable& arguments, bool force) {
  OutputOptions options{.replace = force ? Replace::anything : Replace::own};
  std::error_code none;
  for (const Argument& argument : arguments.all())
    if (!is_output(argument))
      for (const std::filesystem::path& path : paths_of(argument))
        if (!path.empty() && std::filesystem::exists(path, none)) options.inputs.push_back(path);
  return options;
}

constexpr const char* kAnyOutput = "OUT";  ///< a folder or a file, by its format

/// Whether an output is a folder.
bool is_folder(const Argument& output) {
  return output.value_name == "FOLDER" || output.value_name == "POSED";
}

/// Before the work begins: an output must replace no input, no memory (unless it is one, which has rules of
/// its own), and no file that loci did not write.
void check_output(const Argument& output, const std::filesystem::path& path, const OutputOptions& options) {
  std::error_code none;
  const bool is_file = std::filesystem::is_regular_file(path, none);
  if (!is_file && output.name != kOutput) return;  // label images may go beside those that they belong to
  if (!is_file && !is_folder(output) && output.value_name != kAnyOutput) loci::check_output(path, options);
  for (const std::filesystem::path& input : options.inputs)
    if (std::filesystem::equivalent(path, input, none)) refuse_inputs(path, {input});
  if (!is_file) return;
  if (output.value_name != "MEMORY" && is_memory(path))
    throw Error("is a memory, it is not replaced", {path.string(), 0, {}}, "write to another path");
  if (output.replaces) loci::check_output(path, options);
}

/// Before the work begins: the folder that an output goes to can be written, or made.
void require_writable(const std::filesystem::path& output) {
  std::error_code none;
  std::filesystem::path above = std::filesystem::absolute(output, none).lexically_normal();
  const std::filesystem::path own = above;
  while (!std::filesystem::exists(above, none) && above.has_relative_path()) above = above.parent_path();
  if (!std::filesystem::is_directory(above, none)) {
    if (above == own) return;
    throw Error(fmt::format("cannot be written: {} is a file", above.string()), {output.string(), 0, {}},
                "write to another path");
  }
  if (::access(above.c_str(), W_OK | X_OK) != 0)
    throw Error(fmt::format("cannot be written: {}: {}", above.string(), std::strerror(errno)),
                {output.string(), 0, {}}, "write to another path");
}

/// Folders of recordings that a command reads.
std::vector<std::filesystem::path> recordings_of(const ArgumentTable& arguments) {
  std::vector<std::filesystem::path> recordings;
  for (const Argument& argument : arguments.all())
    if (argument.value_name == "RECORDING")
      std::ranges::copy(paths_of(argument), std::back_inserter(recordings));
  return recordings;
}

void check_outputs(const ArgumentTable& arguments, const OutputOptions& options) {
  const std::vector<std::filesystem::path> recordings = recordings_of(arguments);
  std::error_code none;
  for (const Argument& argument : arguments.all()) {
    if (!is_output(argument)) continue;
    for (const std::filesystem::path& path : paths_of(argument)) {
      if (path.empty()) continue;
      if (std::filesystem::exists(path, none)) check_output(argument, path, options);
      if (argument.name == kOutput) refuse_within(path, recordings);
      if (is_folder(argument)) check_folder_name(path);
      require_writable(path);
    }
  }
}

/// The memory to use when none was named, and where its name comes from.
std::pair<std::string, std::string> find_memory() {
  if (const char* file = std::getenv("LOCI_MEMORY"); file != nullptr && *file != '\0')
    return {file, "from LOCI_MEMORY"};
  std::vector<std::string> files;
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator(".", ignored))
    if (entry.path().extension() == ".loci") files.push_back(entry.path().filename().string());
  if (files.size() == 1) return {files.front(), "the only memory in this folder"};
  throw UsageError(files.empty() ? "no memory is named: give -m FILE.loci or set LOCI_MEMORY"
                                 : "several memories are in this folder: name one with -m FILE.loci");
}

/// Names the memory when the command line does not.
void use_memory(const Argument& argument, bool quiet) {
  std::string& file = *std::get<std::string*>(argument.variable);
  if (!file.empty()) return;
  const auto [found, source] = find_memory();
  file = found;
  if (!quiet) print_aside(fmt::format("memory: {} ({})\n", terminal_text(found), source));
}

void install_interrupt_handler() {
  std::signal(SIGINT, on_interrupt);
  std::signal(SIGTERM, on_interrupt);
}

/// Whether the first word after a command may be this one.
bool takes_first(const Command& command, const std::string& word) {
  ArgumentTable arguments;
  const auto body = command.declare(arguments);  // owns the variables
  const auto first = std::ranges::find_if(arguments.all(), &Argument::positional);
  return first != arguments.all().end() &&
         (std::ranges::count(first->choices, word) > 0 || std::ranges::count(first->first_words, word) > 0);
}

bool has_option(const std::vector<std::string>& words, const std::string& option) {
  const auto end = std::find(words.begin(), words.end(), "--");
  return std::find(words.begin(), end, option) != end;
}

}  // namespace

const char* const kVersion = LOCI_VERSION;

int print_version() {
  fmt::print("loci {}\n", kVersion);
  return 0;
}

std::filesystem::path cache_folder() {
  if (const char* folder = std::getenv("XDG_CACHE_HOME"); folder != nullptr && *folder == '/')
    return std::filesystem::path(folder) / "loci";
  if (const char* home = std::getenv("HOME"); home != nullptr && *home == '/')
    return std::filesystem::path(home) / ".cache/loci";
  throw Error("there is no folder for temporary copies", {}, "set HOME or XDG_CACHE_HOME");
}

bool interrupted() {
  return interrupt_requested != 0;
}

const Command& Program::find(const std::string& name) const {
  if (name.empty()) throw UsageError("no command is given");
  std::vector<std::string> names;
  for (const Command& command : commands_) {
    if (command.name == name) return command;
    names.push_back(command.name);
  }
  if (name.starts_with('-')) throw unknown("option", name, {"--help", "--version"});
  // "stow" is meant as "task stow".
  for (const Command& command : commands_)
    if (takes_first(command, name))
      throw UsageError(fmt::format("unknown command '{}' (did you mean '{} {}'?)", name, command.name, name));
  throw unknown("command", name, names);
}

int Program::run_command(const Command& command, const std::vector<std::string>& words) const {
  const bool alone = command.name.empty();  // a program without commands
  const std::string name = alone ? name_ : name_ + " " + command.name;
  CommonFlags flags;
  ArgumentTable arguments;
  const auto body = command.declare(arguments);
  declare_common(arguments, flags, alone);
  if (has_option(words, "--version")) return print_version();
  if (has_option(words, "--help") || has_option(words, "-h")) {
    fmt::print("{}", command_help(name, command, arguments));
    return 0;
  }
  return run_guarded(name, [&] {
    arguments.parse(words);
    for (const Argument& argument : arguments.all())
      if (argument.is_memory) use_memory(argument, flags.quiet);
    if (!alone) {
      install_interrupt_handler();
      keep_freed_memory();
    }
    const OutputOptions outputs = output_options(arguments, flags.force);
    check_outputs(arguments, outputs);
    Session session(flags, outputs);
    try {
      body(session);
    } catch (const Interrupted&) {
      session.show_warnings();
      if (can_resume(arguments)) session.log("what is complete is kept: --resume goes on with it");
      throw;
    } catch (...) {
      session.show_warnings();
      throw;
    }
    session.show_warnings();
    return session.exit_code();
  });
}

int Program::describe() const {
  Json json = {
      {"program", name_}, {"description", description_}, {"version", kVersion}, {"commands", Json::array()}};
  for (const Command& command : commands_) {
    CommonFlags flags;
    ArgumentTable arguments;
    const auto body = command.declare(arguments);  // owns the variables
    declare_common(arguments, flags, command.name.empty());
    json["commands"].push_back(command_json(command, arguments));
  }
  fmt::print("{}\n", json.dump(1));
  return 0;
}

int Program::run(int argc, char** argv) const {
  const std::vector<std::string> words(argv + 1, argv + argc);
  const std::string first = words.empty() ? "" : words[0];
  return run_guarded(name_, [&] {
    if (first == "--describe-cli") return describe();
    if (!has_commands()) return run_command(commands_.front(), words);
    if (first == "--version") return print_version();
    const bool help = first == "help" || first == "--help" || first == "-h";
    if (help && words.size() == 1) {
      fmt::print("{}", program_help(name_, description_, commands_));
      return 0;
    }
    if (help) return run_command(find(words[1]), {"--help"});
    return run_command(find(first), words.empty() ? words : std::vector(words.begin() + 1, words.end()));
  });
}

namespace {

/// The numbers of standard files that are closed would go to files that are opened next, and what is printed
/// into those.
void occupy_standard_files() {
  for (const int standard : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    if (::fcntl(standard, F_GETFD) < 0 && errno == EBADF) {
      // stdout so that writing fails, and what is lost is reported.
      const int opened = ::open("/dev/null", standard == STDERR_FILENO ? O_WRONLY : O_RDONLY);
      if (opened >= 0 && opened != standard) ::close(opened);
    }
}

/// Whether all that was printed is out; what is not is dropped, so that it is reported once.
bool flush_answer() {
  errno = 0;
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return true;
  __fpurge(stdout);
  std::clearerr(stdout);
  return false;
}

int report(const std::string& line, int exit_code) {
  flush_answer();  // what was printed before
  print_aside(line + "\n");
  return exit_code;
}

}  // namespace

void print_aside(std::string_view text) {
  std::fwrite(text.data(), 1, text.size(), stderr);
}

int run_guarded(const std::string& name, const std::function<int()>& main) {
  occupy_standard_files();
  try {
    const int exit_code = main();
    if (flush_answer()) return exit_code;
    throw Error(fmt::format("the answer cannot be written to standard output: {}",
                            errno != 0 ? std::strerror(errno) : "writing failed"));
  } catch (const Interrupted&) {
    return report(name + ": interrupted", 130);
  } catch (const UsageError& error) {
    return report(fmt::format("{}: {}; see {} --help", name, terminal_text(error.what()), name), 2);
  } catch (const std::exception& error) {
    return report(fmt::format("{}: {}", name, terminal_text(error.what())), 1);
  }
}

}  // namespace loci::apps
