#include "apps/cli/arguments.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <stdexcept>

namespace loci::apps {
namespace {

std::string kebab(std::string name) {
  std::replace(name.begin(), name.end(), '_', '-');
  return name;
}

/// "-o,--output FOLDER" taken apart.
Argument named(std::string_view spec) {
  Argument argument;
  if (const size_t comma = spec.find(','); comma != spec.npos) {
    argument.short_name = spec.substr(0, comma);
    spec.remove_prefix(comma + 1);
  }
  const size_t space = std::min(spec.find(' '), spec.size());
  argument.name = spec.substr(0, space);
  if (space < spec.size()) argument.value_name = spec.substr(space + 1);
  return argument;
}

/// What help shows in place of a value when the declaration does not name it.
std::string usual_value_name(const Variable& variable) {
  if (std::holds_alternative<int*>(variable) || std::holds_alternative<uint64_t*>(variable) ||
      std::holds_alternative<std::optional<int64_t>*>(variable))
    return "N";
  if (std::holds_alternative<double*>(variable) || std::holds_alternative<std::optional<double>*>(variable))
    return "NUMBER";
  return "TEXT";
}

std::string value_text(bool value) {
  return value ? "on" : "off";
}
std::string value_text(int value) {
  return std::to_string(value);
}
std::string value_text(uint64_t value) {
  return std::to_string(value);
}
std::string value_text(double value) {
  return fmt::format("{}", value);
}
std::string value_text(const std::optional<int64_t>& value) {
  return value ? std::to_string(*value) : "none";
}
std::string value_text(const std::optional<double>& value) {
  return value ? value_text(*value) : "none";
}
std::string value_text(const std::string& value) {
  return value;
}
std::string value_text(const std::filesystem::path& value) {
  return value.string();
}
template <class Value>
std::string value_text(const std::vector<Value>& values) {
  std::string text;
  for (const Value& value : values) text += (text.empty() ? "" : ", ") + value_text(value);
  return text;
}

template <class Number>
Number number_from(const std::string& text, const char* what) {
  Number value{};
  const char* const end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data() + (text.starts_with('+') ? 1 : 0), end, value);
  if (error != std::errc() || rest != end) throw UsageError(fmt::format("'{}' is not {}", text, what));
  return value;
}

void check_range(const Argument& argument, double value) {
  if (value >= argument.min && value <= argument.max) return;
  const std::string allowed = argument.max < std::numeric_limits<double>::max()
                                  ? fmt::format("{} to {}", argument.min, argument.max)
                                  : fmt::format("at least {}", argument.min);
  throw UsageError(fmt::format("{} is not allowed ({})", value, allowed));
}

void check_choice(const Argument& argument, const std::string& value) {
  const auto& choices = argument.choices;
  if (choices.empty() || std::find(choices.begin(), choices.end(), value) != choices.end()) return;
  throw UsageError(fmt::format("'{}' is not one of {}", value, fmt::join(choices, ", ")));
}

void set(const Argument&, bool& value, const std::vector<std::string>& texts) {
  value = texts.back() == "true";
}

void set(const Argument& argument, int& value, const std::vector<std::string>& texts) {
  value = number_from<int>(texts.front(), "a whole number");
  check_range(argument, value);
}

void set(const Argument& argument, uint64_t& value, const std::vector<std::string>& texts) {
  value = number_from<uint64_t>(texts.front(), "a whole number from 0 on");
  check_range(argument, static_cast<double>(value));
}

void set(const Argument& argument, std::optional<int64_t>& value, const std::vector<std::string>& texts) {
  value = number_from<int64_t>(texts.front(), "a whole number");
  check_range(argument, static_cast<double>(*value));
}

void set(const Argument& argument, double& value, const std::vector<std::string>& texts) {
  value = number_from<double>(texts.front(), "a number");
  if (!std::isfinite(value)) throw UsageError(fmt::format("'{}' is not a finite number", texts.front()));
  check_range(argument, value);
}

void set(const Argument& argument, std::optional<double>& value, const std::vector<std::string>& texts) {
  value.reset();
  if (texts.front() != "none") set(argument, value.emplace(), texts);
}

void set(const Argument& argument, std::vector<double>& values, const std::vector<std::string>& texts) {
  values.clear();
  const std::string& text = texts.front();
  for (size_t begin = 0; begin <= text.size();) {
    const size_t end = std::min(text.find(',', begin), text.size());
    set(argument, values.emplace_back(), {text.substr(begin, end - begin)});
    begin = end + 1;
  }
  if (values.size() != static_cast<size_t>(argument.values))
    throw UsageError(fmt::format("'{}' is not {} numbers with commas between", text, argument.values));
}

void set(const Argument& argument, std::string& value, const std::vector<std::string>& texts) {
  check_choice(argument, texts.front());
  value = texts.front();
}

void set(const Argument&, std::filesystem::path& value, const std::vector<std::string>& texts) {
  value = texts.front();
}

template <class Value>
void set(const Argument& argument, std::vector<Value>& values, const std::vector<std::string>& texts) {
  for (const std::string& text : texts) check_choice(argument, text);
  values.assign(texts.begin(), texts.end());
}

}  // namespace

UsageError unknown(const std::string& kind, const std::string& name, const std::vector<std::string>& known) {
  const std::string hint = did_you_mean(name, known);
  return UsageError(fmt::format("unknown {} '{}'{}", kind, name, hint.empty() ? "" : " (" + hint + ")"));
}

bool Argument::list() const {
  return std::holds_alternative<std::vector<std::string>*>(variable) ||
         std::holds_alternative<std::vector<std::filesystem::path>*>(variable);
}

void ArgumentTable::add(Argument argument, ArgumentDetails details) {
  static_cast<ArgumentDetails&>(argument) = std::move(details);
  if (argument.group.empty()) argument.group = group_;
  arguments_.push_back(std::move(argument));
}

void ArgumentTable::positional(std::string_view spec, Variable variable, std::string description,
                               ArgumentDetails details) {
  details.required = !spec.starts_with('[');
  if (!details.required) spec = spec.substr(1, spec.size() - 2);
  if (spec.ends_with("...")) spec.remove_suffix(3);
  Argument argument;
  argument.name = argument.value_name = spec;
  argument.description = std::move(description);
  argument.variable = variable;
  add(std::move(argument), std::move(details));
}

void ArgumentTable::option(std::string_view spec, Variable variable, std::string description,
                           ArgumentDetails details) {
  Argument argument = named(spec);
  argument.description = std::move(description);
  argument.variable = variable;
  if (argument.value_name.empty()) argument.value_name = usual_value_name(variable);
  add(std::move(argument), std::move(details));
}

void ArgumentTable::flag(std::string_view spec, bool& variable, std::string description,
                         ArgumentDetails details) {
  Argument argument = named(spec);
  argument.description = std::move(description);
  argument.variable = &variable;
  add(std::move(argument), std::move(details));
}

void ArgumentTable::options(const OptionTable& table, const std::string& group) {
  for (const Option& option : table.options()) {
    Argument argument;
    argument.name = "--" + kebab(option.name);
    argument.description = option.description;
    argument.group = group;
    std::visit([&](auto* value) { argument.variable = value; }, option.value);
    argument.negatable = std::holds_alternative<bool*>(option.value);
    if (!argument.negatable) argument.value_name = usual_value_name(argument.variable);
    add(std::move(argument),
        {.unit = option.unit, .min = option.min, .max = option.max, .choices = option.choices});
  }
}

void ArgumentTable::memory(std::string& file) {
  option("-m,--memory MEMORY", &file,
         "The memory: FILE.loci, or postgresql://…/DATABASE?robot=NAME to read one");
  arguments_.back().is_memory = true;
  arguments_.back().default_text = "$LOCI_MEMORY, or the only *.loci file here";
}

void ArgumentTable::time_zone(std::string& zone) {
  option("--time-zone ZONE", &zone, "Zone of people's times in a new memory: Europe/Berlin, UTC, +02:00",
         {.default_text = "the recording's, or the machine's"});
}

void ArgumentTable::now(std::string& time) {
  option("--now TIME", &time, "Transaction time of the rows, ISO 8601", {.default_text = "the clock"});
}

void ArgumentTable::output(std::string_view value_name, Variable variable, std::string description,
                           ArgumentDetails details) {
  details.required = true;
  option(fmt::format("-o,--output {}", value_name), variable, std::move(description), std::move(details));
}

void ArgumentTable::package_path(Variable folders) {
  option("--package-path FOLDER", folders,
         "Folder with packages, for package://NAME/… in a URDF; may be repeated");
}

const Argument* ArgumentTable::find(std::string_view name) const {
  const auto found = std::find_if(arguments_.begin(), arguments_.end(), [&](const Argument& argument) {
    return argument.name == name || (!argument.short_name.empty() && argument.short_name == name);
  });
  return found == arguments_.end() ? nullptr : &*found;
}

Argument& ArgumentTable::at(std::string_view name) {
  const Argument* found = find(name);
  if (found == nullptr) throw std::logic_error("undeclared argument " + std::string(name));
  return arguments_[static_cast<size_t>(found - arguments_.data())];
}

void set_value(const Argument& argument, const std::vector<std::string>& texts) {
  try {
    std::visit([&](auto* value) { set(argument, *value, texts); }, argument.variable);
  } catch (const UsageError& error) {
    throw UsageError(argument.name + ": " + error.message());
  }
}

std::string spelling(const Argument& argument) {
  if (argument.positional()) return argument.list() ? argument.name + "..." : argument.name;
  std::string text = argument.short_name.empty() ? "" : argument.short_name + ", ";
  text += argument.negatable ? "--[no-]" + argument.name.substr(2) : argument.name;
  if (!argument.value_name.empty()) text += " " + argument.value_name;
  return text;
}

std::string default_text(const Argument& argument) {
  std::string text = argument.default_text;
  const bool shows_value = !argument.required && (argument.negatable || !argument.flag());
  if (text.empty() && shows_value)
    text = std::visit([](const auto* value) { return value_text(*value); }, argument.variable);
  if (!argument.unit.empty()) text += (text.empty() ? "" : text == "none" ? ", in " : " ") + argument.unit;
  return text.empty() ? "" : "[" + text + "]";
}

}  // namespace loci::apps
