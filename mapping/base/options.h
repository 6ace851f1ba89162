#pragma once

#include <limits>
#include <string>
#include <variant>
#include <vector>

#include "mapping/base/error.h"
#include "mapping/base/text/json_fwd.h"

namespace loci {

class Config;

/// One option of a stage: its value, unit, bounds and description.
struct Option {
  using Value = std::variant<bool*, int*, double*, std::string*, std::vector<std::string>*>;

  std::string name;  ///< snake_case, with the unit where it is not SI ("yaw_deg"); also the YAML key
  Value value;       ///< points into the options struct; holds the default when declared on a fresh struct
  std::string unit;  ///< "m", "deg", "px", "" for none
  std::string description;
  double min = -std::numeric_limits<double>::infinity();  ///< of numbers, inclusive
  double max = std::numeric_limits<double>::infinity();
  std::vector<std::string> choices;  ///< of strings; empty = any
};

/// The options of one stage, declared once; YAML, command line, documentation and outputs are made from it.
///
///   struct ClusterOptions {
///     double tolerance_m = 0.02;
///     void declare(OptionTable& table) {
///       table.number("tolerance_m", tolerance_m, "m", "Largest gap inside one object.", 0.001, 1);
///     }
///   };
class OptionTable {
 public:
  void flag(std::string name, bool& value, std::string description);
  void integer(std::string name, int& value, std::string unit, std::string description, int min, int max);
  void number(std::string name, double& value, std::string unit, std::string description, double min,
              double max);
  void text(std::string name, std::string& value, std::string description,
            std::vector<std::string> choices = {});
  void texts(std::string name, std::vector<std::string>& value, std::string description);

  const std::vector<Option>& options() const { return options_; }

  /// Sets what the map gives; bounds are left to validate(), unknown keys to config.finish().
  void read(const Config& config);
  /// Reads a map that holds these options and nothing else, and validates them.
  void read_all(const Config& config);
  /// Throws one Error that names all values outside their bounds; `location` says whose options they are.
  void validate(const FileLocation& location = {}) const;
  /// The effective configuration, for outputs and listings.
  Json to_json() const;

 private:
  std::vector<Option> options_;
};

/// The value of an option as text, as it would be written in YAML.
std::string option_text(const Option& option);

/// The declared table of an options struct.
template <class Options>
OptionTable table_of(Options& options) {
  OptionTable table;
  options.declare(table);
  return table;
}

/// Fresh options from a YAML map, read strictly and validated.
template <class Options>
Options read_options(const Config& config) {
  Options options;
  table_of(options).read_all(config);
  return options;
}

}  // namespace loci
