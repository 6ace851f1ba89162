#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "mapping/base/error.h"
#include "mapping/base/options.h"

namespace loci::apps {

/// A command line that does not fit the declared arguments. Programs print it in one line and exit 2.
class UsageError : public Error {
 public:
  using Error::Error;
};

/// "unknown command 'chek' (did you mean 'check'?)".
UsageError unknown(const std::string& kind, const std::string& name, const std::vector<std::string>& known);

/// The variable that an argument sets; its value at the declaration is the default. An optional number also
/// takes "none", a list of numbers is one value with commas ("1.5,2,90").
using Variable =
    std::variant<bool*, int*, uint64_t*, std::optional<int64_t>*, double*, std::optional<double>*,
                 std::vector<double>*, std::string*, std::filesystem::path*, std::vector<std::string>*,
                 std::vector<std::filesystem::path>*>;

/// What only some arguments have.
struct ArgumentDetails {
  bool required = false;          ///< of an option; a positional without [] is required
  std::string unit = {};          ///< "m", "deg"
  std::string default_text = {};  ///< shown instead of the value of the variable
  double min = -std::numeric_limits<double>::infinity();  ///< of numbers, inclusive
  double max = std::numeric_limits<double>::infinity();
  std::vector<std::string> choices = {};      ///< the only values allowed
  std::vector<std::string> first_words = {};  ///< of a list: what its first value may be, for hints
  int values = 1;         ///< how many follow one occurrence of an option, or have commas between
  bool open_end = false;  ///< any number of values follow one occurrence of a list option
  std::vector<std::string> needs = {};     ///< options without which this one means nothing
  std::vector<std::string> excludes = {};  ///< arguments that cannot be given together with this one
  bool* given = nullptr;                   ///< set when the argument stands on the command line
  bool hidden = false;                     ///< not in help, completions and manual
  bool replaces = false;                   ///< an output: --force replaces what loci did not write
};

/// One argument of a command.
struct Argument : ArgumentDetails {
  std::string name;        ///< "RECORDING" or "--output"
  std::string short_name;  ///< "-o", or empty
  std::string value_name;  ///< what help shows in place of a value: "FOLDER"; empty for flags
  std::string description;
  std::string group;  ///< heading in help
  Variable variable;
  bool negatable = false;  ///< --no-NAME switches it off
  bool is_memory = false;  ///< see ArgumentTable::memory

  bool positional() const { return name.front() != '-'; }
  bool flag() const { return value_name.empty(); }
  bool list() const;  ///< may be given several times
};

/// The arguments of a command, declared once: parsing, help, completions and manual pages derive from them.
class ArgumentTable {
 public:
  /// `spec` is as in a usage line: "RECORDING", "IMAGE..." for a list, "[PLACE]" when it may be left out.
  void positional(std::string_view spec, Variable variable, std::string description,
                  ArgumentDetails details = {});
  /// "--every N", "-o,--output FOLDER". An option of a list may be repeated.
  void option(std::string_view spec, Variable variable, std::string description,
              ArgumentDetails details = {});
  /// "--resume".
  void flag(std::string_view spec, bool& variable, std::string description, ArgumentDetails details = {});
  /// The options of a stage as --kebab-case, under a heading of their own.
  void options(const OptionTable& table, const std::string& group = {});
  /// The memory that a command works on, "-m,--memory": given, or in LOCI_MEMORY, or the only *.loci file of
  /// the current folder.
  void memory(std::string& file);
  /// "--time-zone ZONE" of a memory that the command makes. What is known otherwise stays empty.
  void time_zone(std::string& zone);
  /// "--now TIME" of what is written into a memory; empty = that of the clock.
  void now(std::string& time);
  /// "-o,--output VALUE_NAME", required.
  void output(std::string_view value_name, Variable variable, std::string description,
              ArgumentDetails details = {});
  /// "--package-path FOLDER".
  void package_path(Variable folders);
  /// Heading of the arguments declared from now on.
  void begin_group(std::string name) { group_ = std::move(name); }

  const std::vector<Argument>& all() const { return arguments_; }
  const Argument* find(std::string_view name) const;
  /// For what a declaration by `options` cannot say. The argument must exist.
  Argument& at(std::string_view name);

  /// Sets the variables from the words of a command line. UsageError when these do not fit.
  void parse(const std::vector<std::string>& words) const;

 private:
  void add(Argument argument, ArgumentDetails details);

  std::vector<Argument> arguments_;
  std::string group_;
};

/// Sets the variable of an argument from what was given for it. UsageError when that does not fit.
void set_value(const Argument& argument, const std::vector<std::string>& texts);
/// "-o, --output FOLDER", "--[no-]compare", "RECORDING".
std::string spelling(const Argument& argument);
/// Default and unit in the one form that help and manual print: "[0.02 m]"; empty when there are none.
std::string default_text(const Argument& argument);

}  // namespace loci::apps
