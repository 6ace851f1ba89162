#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <utility>
#include <vector>

#include "perception/detection/detection_set.h"

namespace loci::perception {

// Values of detections in JSON are read strictly: Error, with the key `where` as its place, for what is of
// another type, not finite or out of bounds.

double finite_number(const nlohmann::json& value, const std::string& where);
double bounded_number(const nlohmann::json& value, const std::string& where, double low, double high);
std::string text_of(const nlohmann::json& value, const std::string& where);
const nlohmann::json& require_list(const nlohmann::json& value, const std::string& where);
const nlohmann::json& require_object(const nlohmann::json& value, const std::string& where);

/// A name, or probabilities by name, which are divided by their sum where it is above one. The best first.
std::vector<std::pair<std::string, double>> classes_of(const nlohmann::json& value, const std::string& where);
/// {"name": [x, y]}, pixels.
std::vector<KeyPoint2D> key_points_of(const nlohmann::json& value, const std::string& where);

}  // namespace loci::perception
