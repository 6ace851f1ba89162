#pragma once

#include <algorithm>
#include <array>
#include <string_view>

namespace loci::mapping {

/// Whether links of a class (SemanticLink::class_name) have a horizontal surface that things stand on.
inline bool is_support_class(std::string_view class_name) {
  constexpr std::array<std::string_view, 5> kSupports = {"counter", "island", "table", "shelf", "cabinet"};
  return std::ranges::find(kSupports, class_name) != kSupports.end();
}

}  // namespace loci::mapping
