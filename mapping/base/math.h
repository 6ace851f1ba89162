#pragma once

#include <numbers>

namespace loci {

inline constexpr double kPi = std::numbers::pi;
inline constexpr double kDegree = kPi / 180;  ///< radians

}  // namespace loci
