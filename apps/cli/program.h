#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "apps/cli/arguments.h"
#include "mapping/base/error.h"
#include "mapping/base/output_file.h"
#include "mapping/base/progress.h"
#include "mapping/base/text/json_fwd.h"

namespace loci::apps {

/// What every command takes.
struct CommonFlags {
  bool json = false;     ///< --json: the answer as JSON on stdout
  bool quiet = false;    ///< --quiet: no progress, no warnings
  bool verbose = false;  ///< --verbose: every warning
  bool timing = false;   ///< --timing: time of each stage, on stderr
  bool force = false;    ///< --force: replace outputs that loci did not write
  int threads = 0;       ///< --threads: 0 = all cores
};

/// What a command uses while it runs.
class Session {
 public:
  Session(const CommonFlags& flags, OutputOptions outputs);
  ~Session();

  const CommonFlags& flags() const { return flags_; }
  /// How the command may write: what it reads is never replaced, what loci did not write only with --force.
  const OutputOptions& outputs() const { return outputs_; }
  /// Throws Error when one of the files must not be written. Files that an argument names have been checked
  /// when the command starts; this is for those that it writes beside them, or into a folder.
  void check_outputs(const std::filesystem::path& folder, const std::vector<std::string>& names) const;
  /// A bar with rate and time left on a terminal, plain lines in a log, nothing with --quiet. It asks to stop
  /// after Ctrl-C.
  Progress& progress() { return *progress_; }
  /// Collected warnings, printed when the command ends: the first five, all with --verbose.
  Warnings& warnings() { return warnings_; }
  /// Prints the answer: `text`, or `json` with --json. stdout carries nothing else.
  void answer(const std::string& text, const Json& json);
  /// Prints a line on stderr, not with --quiet.
  void log(const std::string& line);
  /// Prints the time of a stage on stderr with --timing.
  void timing(const std::string& stage, double seconds);
  void show_warnings();
  int exit_code() const { return exit_code_; }
  void set_exit_code(int code) { exit_code_ = code; }

 private:
  CommonFlags flags_;
  OutputOptions outputs_;
  int exit_code_ = 0;
  std::unique_ptr<Progress> progress_;
  Warnings warnings_;
};

/// The zone of this machine's clock: TZ, or what is set for all programs.
std::string machine_time_zone();

/// One command of a program, e.g. `loci-map fuse`.
struct Command {
  std::string name;
  std::string description;            ///< one line, for lists
  std::vector<std::string> examples;  ///< at least two, which work as printed
  /// Declares the arguments and returns what to run after parsing.
  std::function<std::function<void(Session&)>(ArgumentTable&)> declare;
  std::string group = {};  ///< heading in the program's help; empty = "Commands"
};

/// A program of commands, or of one command without a name. Exit codes: 0 done, 1 error (one line on stderr),
/// 2 usage, 130 interrupted.
class Program {
 public:
  Program(std::string name, std::string description)
      : name_(std::move(name)), description_(std::move(description)) {}

  void add(Command command) { commands_.push_back(std::move(command)); }
  int run(int argc, char** argv) const;

 private:
  bool has_commands() const { return commands_.size() != 1 || !commands_.front().name.empty(); }
  const Command& find(const std::string& name) const;
  int run_command(const Command& command, const std::vector<std::string>& words) const;
  int describe() const;

  std::string name_;
  std::string description_;
  std::vector<Command> commands_;
};

extern const char* const kVersion;  ///< "0.1.0"
int print_version();

/// Runs `main` and turns an exception into one line on stderr and an exit code.
int run_guarded(const std::string& name, const std::function<int()>& main);

/// Where files go that can be made anew: $XDG_CACHE_HOME/loci, or ~/.cache/loci.
std::filesystem::path cache_folder();

/// Whether Ctrl-C was pressed while a command runs.
bool interrupted();

}  // namespace loci::apps
