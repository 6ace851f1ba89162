#include "memory/questions/names/seen_colors.h"

#include <algorithm>
#include <map>

#include "mapping/base/text/json.h"
#include "memory/questions/names/structure_features.h"

namespace loci::memory {
namespace {

constexpr const char* kColorType = "loci.annotation.ColorAnnotation";

/// Adds the fraction that one view shows of each colour; false where the annotation says none.
bool add_fractions(const Store& store, const AnnotationRow& row, std::map<std::string, double>& sums) {
  for (const Json& features : features_of(store, row, kColorType)) {
    const auto names = features.find("names"), fractions = features.find("fractions");
    if (names == features.end() || fractions == features.end() || !names->is_array() ||
        !fractions->is_array() || names->empty() || names->size() != fractions->size())
      continue;
    for (size_t i = 0; i < names->size(); ++i)
      if ((*names)[i].is_string() && (*fractions)[i].is_number())
        sums[(*names)[i].get<std::string>()] += (*fractions)[i].get<double>();
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
  for (const auto& annotation :
       store.latest_observations(object, kLatestViews, {kColorType}, as_of).annotations)
    if (add_fractions(store, annotation.row, sums)) ++views;
  std::vector<std::string> colors;
  for (const auto& [name, sum] : sums)
    if (sum >= kMinShare * static_cast<double>(views)) colors.push_back(name);
  std::ranges::stable_sort(colors, std::greater(), [&](const std::string& name) { return sums.at(name); });
  return colors;
}

}  // namespace loci::memory
