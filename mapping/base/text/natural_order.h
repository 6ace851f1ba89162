#pragma once

#include <string_view>

namespace loci {

/// Whether a name comes before another where numbers in them count as numbers: door_2 before door_10.
bool natural_less(std::string_view a, std::string_view b);

/// For ordered containers.
struct NaturalOrder {
  using is_transparent = void;
  bool operator()(std::string_view a, std::string_view b) const { return natural_less(a, b); }
};

}  // namespace loci
