#include "mapping/base/options.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "mapping/base/config.h"
#include "mapping/base/text/json.h"

namespace loci {
namespace {

template <class... Cases>
struct Overloaded : Cases... {
  using Cases::operator()...;
};
template <class... Cases>
Overloaded(Cases...) -> Overloaded<Cases...>;

std::string problem_of(const Option& option) {
  const auto outside = [&](double value) -> std::string {
    if (std::isfinite(value) && value >= option.min && value <= option.max) return {};
    return fmt::format("{} is {}, allowed is {} to {}", option.name, value, option.min, option.max);
  };
  return std::visit(
      Overloaded{
          [&](const double* value) { return outside(*value); },
          [&](const int* value) { return outside(*value); },
          [&](const std::string* value) -> std::string {
            const auto& choices = option.choices;
            if (choices.empty() || std::find(choices.begin(), choices.end(), *value) != choices.end())
              return {};
            return fmt::format("{} is '{}', allowed is {}", option.name, *value, fmt::join(choices, ", "));
          },
          [](const auto*) { return std::string(); },
      },
      option.value);
}

}  // namespace

void OptionTable::flag(std::string name, bool& value, std::string description) {
  options_.push_back({std::move(name), &value, "", std::move(description), 0, 1, {}});
}

void OptionTable::integer(std::string name, int& value, std::string unit, std::string description, int min,
                          int max) {
  options_.push_back({std::move(name),
                      &value,
                      std::move(unit),
                      std::move(description),
                      static_cast<double>(min),
                      static_cast<double>(max),
                      {}});
}

void OptionTable::number(std::string name, double& value, std::string unit, std::string description,
                         double min, double max) {
  options_.push_back({std::move(name), &value, std::move(unit), std::move(description), min, max, {}});
}

void OptionTable::text(std::string name, std::string& value, std::string description,
                       std::vector<std::string> choices) {
  options_.push_back({std::move(name), &value, "", std::move(description), 0, 0, std::move(choices)});
}

void OptionTable::texts(std::string name, std::vector<std::string>& value, std::string description) {
  options_.push_back({std::move(name), &value, "", std::move(description), 0, 0, {}});
}

void OptionTable::read(const Config& config) {
  for (Option& option : options_)
    std::visit(
        [&](auto* value) {
          using T = std::remove_pointer_t<decltype(value)>;
          *value = config.get<T>(option.name, *value);
        },
        option.value);
}

void OptionTable::read_all(const Config& config) {
  read(config);
  config.finish();
  validate(config.location());
}

void OptionTable::validate(const FileLocation& location) const {
  std::vector<std::string> problems;
  for (const Option& option : options_)
    if (std::string problem = problem_of(option); !problem.empty()) problems.push_back(std::move(problem));
  if (!problems.empty()) throw Error(fmt::format("{}", fmt::join(problems, "; ")), location);
}

Json OptionTable::to_json() const {
  Json json = Json::object();
  for (const Option& option : options_)
    std::visit([&](const auto* value) { json[option.name] = *value; }, option.value);
  return json;
}

std::string option_text(const Option& option) {
  return std::visit(
      Overloaded{
          [](const std::vector<std::string>* value) { return fmt::format("[{}]", fmt::join(*value, ", ")); },
          [](const auto* value) { return fmt::format("{}", *value); },
      },
      option.value);
}

}  // namespace loci
