#include "perception/detection/detection_values.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace loci::perception {
namespace {

using nlohmann::json;

[[noreturn]] void refuse_value(const std::string& where, const std::string& what) {
  throw Error(what, {{}, 0, where});
}

}  // namespace

double finite_number(const json& value, const std::string& where) {
  if (!value.is_number()) refuse_value(where, fmt::format("must be a number, is {}", value.type_name()));
  const auto number = value.get<double>();
  if (!std::isfinite(number)) refuse_value(where, "must be a finite number");
  return number;
}

double bounded_number(const json& value, const std::string& where, double low, double high) {
  const double number = finite_number(value, where);
  if (number < low || number > high)
    refuse_value(where, fmt::format("must be from {} to {}, is {}", low, high, number));
  return number;
}

std::string text_of(const json& value, const std::string& where) {
  if (!value.is_string()) refuse_value(where, fmt::format("must be text, is {}", value.type_name()));
  return value.get<std::string>();
}

const json& require_list(const json& value, const std::string& where) {
  if (!value.is_array()) refuse_value(where, fmt::format("must be a list [...], is {}", value.type_name()));
  return value;
}

const json& require_object(const json& value, const std::string& where) {
  if (!value.is_object())
    refuse_value(where, fmt::format("must be an object {{...}}, is {}", value.type_name()));
  return value;
}

std::vector<std::pair<std::string, double>> classes_of(const json& value, const std::string& where) {
  if (value.is_string()) {
    if (value.get<std::string>().empty()) refuse_value(where, "must not be empty");
    return {{value.get<std::string>(), 1.0}};
  }
  std::vector<std::pair<std::string, double>> classes;
  double sum = 0;
  for (const auto& [name, probability] : require_object(value, where).items()) {
    if (name.empty()) refuse_value(where, "has a class without a name");
    classes.emplace_back(name, bounded_number(probability, fmt::format("{}.{}", where, name), 0, 1));
    sum += classes.back().second;
  }
  // Detectors with independent outputs give more than one in total.
  if (sum > 1)
    for (auto& [name, probability] : classes) probability /= sum;
  std::ranges::stable_sort(classes, [](const auto& a, const auto& b) { return a.second > b.second; });
  return classes;
}

std::vector<KeyPoint2D> key_points_of(const json& value, const std::string& where) {
  std::vector<KeyPoint2D> points;
  for (const auto& [name, at] : require_object(value, where).items()) {
    const std::string here = fmt::format("{}.{}", where, name);
    if (!at.is_array() || at.size() != 2) refuse_value(here, "must be 2 numbers");
    points.push_back({name, finite_number(at[0], here), finite_number(at[1], here)});
  }
  return points;
}

}  // namespace loci::perception
