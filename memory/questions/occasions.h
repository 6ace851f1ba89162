#pragma once

#include <array>
#include <string_view>

namespace loci::memory {

/// When an occasion is, by local hours.
struct Occasion {
  const char* name;
  int first_hour, last_hour;
  bool covers(int hour) const { return hour >= first_hour && hour <= last_hour; }
};
inline constexpr std::array<Occasion, 5> kOccasions = {
    {{"breakfast", 5, 10}, {"lunch", 11, 14}, {"tea", 15, 17}, {"dinner", 17, 22}, {"supper", 17, 22}}};

/// nullptr for a name that is none.
inline const Occasion* occasion_called(std::string_view name) {
  for (const Occasion& occasion : kOccasions)
    if (name == occasion.name) return &occasion;
  return nullptr;
}

}  // namespace loci::memory
