#include "perception/detection/detection_values.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "mapping/base/text/json.h"

namespace loci::perception {
namespace {

using nlohmann::json;

[[noreturn]] void refuse_value(const std::string& where, const std::string& what) {
  throw Error(what, {{}, 0, where});
}

constexpr std::array<std::string_view, 3> kNoNumbers = {"NaN", "Infinity", "-Infinity"};
constexpr char kMark = '\x7f';  ///< of the texts that they become; people type no such character

/// The text with numbers that are none as marked texts.
std::string with_quoted_nan(std::string_view text) {
  std::string quoted;
  bool in_string = false;
  for (size_t i = 0; i < text.size(); ++i) {
    const auto starts = [&](std::string_view word) { return text.substr(i).starts_with(word); };
    const auto word = std::ranges::find_if(kNoNumbers, starts);
    if (!in_string && word != kNoNumbers.end()) {
      quoted.append({'"', kMark}).append(*word).append(1, '"');
      i += word->size() - 1;
      continue;
    }
    if (text[i] == '"') in_string = !in_string;
    quoted += text[i];
    if (in_string && text[i] == '\\' && i + 1 < text.size()) quoted += text[++i];  // whatever it escapes
  }
  return quoted;
}

/// Error for a value that was no number.
void refuse_nan(const json& value, const std::string& where, const char* expected) {
  if (!value.is_string()) return;
  const std::string_view text = value.get_ref<const std::string&>();
  if (text.starts_with(kMark))
    refuse_value(where, fmt::format("must be {}, is {}", expected, text.substr(1)));
}

/// `byte` counts from 1.
[[noreturn]] void refuse_text(std::string_view text, size_t byte, std::string_view message) {
  const std::string_view before = text.substr(0, byte > 0 ? byte - 1 : 0);
  const auto lines = std::ranges::count(before, '\n');
  const size_t column = before.size() - (before.rfind('\n') + 1) + 1;  // npos + 1 = 0
  const bool several = text.find('\n') < text.find_last_not_of(" \t\r\n");
  const std::string what = message.find("UTF-8") != std::string_view::npos ? "has invalid UTF-8"
                           : byte > text.find_last_not_of(" \t\r\n") + 1 ? "is not valid JSON: it is cut off"
                                                                         : "is not valid JSON";
  throw Error(fmt::format("{} at byte {}", what, column),
              {{}, several ? static_cast<int>(lines) + 1 : 0, {}});
}

}  // namespace

json parse_values(std::string_view text) {
  check_json_depth(text, {});
  try {
    return json::parse(text);
  } catch (const json::parse_error& error) {
    const std::string quoted = with_quoted_nan(text);
    if (quoted.size() > text.size()) try {
        return json::parse(quoted);
      } catch (const json::exception&) {  // the first mistake is reported
      }
    refuse_text(text, error.byte, error.what());
  } catch (const json::exception&) {
    throw Error("has a number that is too large");
  }
}

double finite_number(const json& value, const std::string& where) {
  refuse_nan(value, where, "a finite number");
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
  refuse_nan(value, where, "text");
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
    const std::string name = text_of(value, where);
    if (name.empty()) refuse_value(where, "must not be empty");
    return {{name, 1.0}};
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

const json& detections_of(const json& scene) {
  const auto found = scene.find("detections");
  if (found != scene.end() && !found->is_null()) return *found;
  std::vector<std::string> keys;
  for (const auto& [key, value] : scene.items())
    if (key != "time") keys.push_back(key);
  const std::string near = nearest_name("detections", keys);
  throw Error("has no 'detections'", {},
              near.empty() ? "[] says that nothing was detected"
                           : fmt::format("write 'detections' instead of '{}'", near));
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
