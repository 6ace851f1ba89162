#pragma once

#include <algorithm>
#include <cstddef>
#include <numbers>
#include <utility>
#include <vector>

namespace loci {

inline constexpr double kPi = std::numbers::pi;
inline constexpr double kDegree = kPi / 180;  ///< radians

/// The element of nearest rank: fraction 0 gives the smallest, 0.5 the (upper) median, 1 the largest.
/// `values` must not be empty.
template <class Value>
Value quantile(std::vector<Value> values, double fraction) {
  const auto rank = static_cast<std::ptrdiff_t>(fraction * static_cast<double>(values.size() - 1) + 0.5);
  std::nth_element(values.begin(), values.begin() + rank, values.end());
  return values[static_cast<size_t>(rank)];
}

/// Two quantiles, low ≤ high, at little more than the cost of one. Reorders `values`.
template <class Value>
std::pair<Value, Value> quantiles(std::vector<Value>& values, double low, double high) {
  const auto rank = [&](double fraction) {
    return values.begin() +
           static_cast<std::ptrdiff_t>(fraction * static_cast<double>(values.size() - 1) + 0.5);
  };
  const auto first = rank(low), second = rank(high);
  std::nth_element(values.begin(), first, values.end());
  if (second != first) std::nth_element(first + 1, second, values.end());
  return {*first, *second};
}

template <class Value>
Value median(std::vector<Value> values) {
  return quantile(std::move(values), 0.5);
}

}  // namespace loci
