#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "perception/detection/detection_set.h"

namespace loci::perception {

/// Parses JSON text. Numbers that are none, which Python writes as NaN and Infinity, are kept, so that the
/// functions below refuse them with their key. Error with the line where there are several, and the
/// byte in it.
nlohmann::json parse_values(std::string_view text);

// Values of detections in JSON are read strictly: Error, with the key `where` as its place, for what is of
// another type, not finite or out of bounds.

double finite_number(const nlohmann::json& value, const std::string& where);
double bounded_number(const nlohmann::json& value, const std::string& where, double low, double high);
std::string text_of(const nlohmann::json& value, const std::string& where);
const nlohmann::json& require_list(const nlohmann::json& value, const std::string& where);
const nlohmann::json& require_object(const nlohmann::json& value, const std::string& where);

/// A name, or probabilities by name, which are divided by their sum where it is above one. The best first.
std::vector<std::pair<std::string, double>> classes_of(const nlohmann::json& value, const std::string& where);
/// What a scene of JSON Lines says that was detected. Error when it does not: [] = nothing was.
const nlohmann::json& detections_of(const nlohmann::json& scene);

/// What to do with scenes that are a list in JSON.
inline constexpr const char* kScenePerLine = "write one scene per line, for example with `jq -c '.[]' FILE`";

/// {"name": [x, y]}, pixels.
std::vector<KeyPoint2D> key_points_of(const nlohmann::json& value, const std::string& where);

}  // namespace loci::perception
