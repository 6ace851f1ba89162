#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "mapping/base/error.h"
#include "mapping/base/json_fwd.h"
#include "mapping/base/options.h"
#include "mapping/base/progress.h"

namespace loci::apps {

/// What every command takes.
struct CommonFlags {
  bool json = false;     ///< --json: the answer as JSON on stdout
  bool quiet = false;    ///< --quiet: no progress, no warnings
  bool verbose = false;  ///< --verbose: every warning
  bool timing = false;   ///< --timing: where the time went, on stderr
  int threads = 0;       ///< --threads: 0 = all cores
};

/// What a command has at hand while it runs.
class Session {
 public:
  explicit Session(const CommonFlags& flags);
  ~Session();

  const CommonFlags& flags() const { return flags_; }
  /// A bar with rate and time left on a terminal, plain lines in a log, nothing with --quiet; says stop after
  /// Ctrl-C.
  Progress& progress() { return *progress_; }
  /// Collected warnings: shown when the command ends (the first five, all with --verbose).
  Warnings& warnings() { return warnings_; }
  /// The answer: `text` for people, or `json` with --json. stdout carries nothing else.
  void answer(const std::string& text, const Json& json);
  /// A line about where the time went, shown with --timing.
  void timing(const std::string& stage, double seconds);
  void show_warnings();

 private:
  CommonFlags flags_;
  std::unique_ptr<Progress> progress_;
  Warnings warnings_;
};

/// One command of a program, e.g. `loci-map fuse`.
struct Command {
  std::string name;
  std::string description;            ///< one line, for the list
  std::vector<std::string> examples;  ///< two that work as printed
  /// Declares arguments on the subcommand and returns what to run after parsing.
  std::function<std::function<void(Session&)>(CLI::App&)> declare;
};

/// A program of subcommands. Exit codes: 0 done, 1 error (one line on stderr), 2 usage, 130 interrupted.
class Program {
 public:
  Program(std::string name, std::string description);

  void add(Command command);
  int run(int argc, char** argv);

 private:
  std::vector<std::string> commands() const;

  std::string name_;
  CLI::App app_;
  CommonFlags flags_;
  std::vector<std::pair<CLI::App*, std::function<void(Session&)>>> runs_;
};

/// Declares the options of a stage as --kebab-case flags on a command.
void add_options(CLI::App& app, const OptionTable& table);

/// Runs `main` and turns what escapes into one line and an exit code, for programs without subcommands.
int run_guarded(const std::string& program, const std::function<int()>& main);

/// Whether Ctrl-C was pressed since install_interrupt_handler().
bool interrupted();
void install_interrupt_handler();

}  // namespace loci::apps
