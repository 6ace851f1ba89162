#include "memory/questions/names/seen_colors.h"

#include <algorithm>
#include <map>

#include "mapping/base/text/json.h"

namespace loci::memory {
namespace {

constexpr const char* kType = "loci.annotation.ColorAnnotation";

/// Adds the fraction that one view shows of each colour; false where the structure says none.
bool add_fractions(const Store& store, Id feature_structure, std::map<std::string, double>& sums) {
  const Json json = parse_json(store.feature_structure(feature_structure).json, "feature_structure");
  for (const Json& structure : json.value("structures", Json::array())) {
    const Json features = structure.value("features", Json::object());
    const Json names = features.value("names", Json::array()),
               fractions = features.value("fractions", Json::array());
    if (structure.value("type", std::string()) != kType || names.empty() || names.size() != fractions.size())
      continue;
    for (size_t i = 0; i < names.size(); ++i)
      if (names[i].is_string() && fractions[i].is_number())
        sums[names[i].get<std::string>()] += fractions[i].get<double>();
    return true;
  }
  return false;
}

}  // namespace

std::vector<std::string> seen_colors(const Store& store, Id object, const AsOf& as_of) {
  constexpr size_t kLatestViews = 12;
  constexpr double kMinShare = 0.1;
  std::map<std::string, double> sums;
  size_t views = 0;
  for (const auto& annotation : store.latest_observations(object, kLatestViews, {kType}, as_of).annotations)
    if (annotation.row.feature_structure && add_fractions(store, *annotation.row.feature_structure, sums))
      ++views;
  std::vector<std::string> colors;
  for (const auto& [name, sum] : sums)
    if (sum >= kMinShare * static_cast<double>(views)) colors.push_back(name);
  std::ranges::stable_sort(colors, std::greater(), [&](const std::string& name) { return sums.at(name); });
  return colors;
}

}  // namespace loci::memory
