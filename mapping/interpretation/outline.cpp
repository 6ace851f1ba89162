#include <algorithm>
#include <map>

#include "mapping/interpretation/supports.h"

namespace loci::mapping {
namespace {

std::vector<double> sorted_bounds(const std::vector<Extent>& parts, int axis) {
  std::vector<double> bounds;
  for (const Extent& part : parts) {
    bounds.push_back(part.min[axis]);
    bounds.push_back(part.max[axis]);
  }
  std::sort(bounds.begin(), bounds.end());
  // Rectangles that end within a few centimetres of each other end together.
  constexpr double kTogether = 0.06;
  std::vector<double> merged;
  for (const double bound : bounds)
    if (merged.empty() || bound - merged.back() > kTogether) merged.push_back(bound);
  merged.back() = bounds.back();
  return merged;
}

/// Drops corners that lie on a straight line.
std::vector<Vector2d> without_straight(const std::vector<Vector2d>& corners) {
  std::vector<Vector2d> kept;
  for (size_t i = 0; i < corners.size(); ++i) {
    const Vector2d before = corners[i] - corners[(i + corners.size() - 1) % corners.size()];
    const Vector2d after = corners[(i + 1) % corners.size()] - corners[i];
    if (std::abs(before.x() * after.y() - before.y() * after.x()) > 1e-9) kept.push_back(corners[i]);
  }
  return kept;
}

/// The outer boundary, counter-clockwise, of a union of rectangles in their axes.
std::vector<Vector2d> union_outline(const std::vector<Extent>& parts) {
  const std::vector<double> xs = sorted_bounds(parts, 0);
  const std::vector<double> ys = sorted_bounds(parts, 1);
  const int columns = static_cast<int>(xs.size()) - 1;
  const int rows = static_cast<int>(ys.size()) - 1;
  const auto filled = [&](int i, int j) {
    if (i < 0 || j < 0 || i >= columns || j >= rows) return false;
    const auto x = static_cast<size_t>(i);
    const auto y = static_cast<size_t>(j);
    const Vector2d middle((xs[x] + xs[x + 1]) / 2, (ys[y] + ys[y + 1]) / 2);
    return std::any_of(parts.begin(), parts.end(), [&](const Extent& part) { return part.contains(middle); });
  };
  // Edges of filled cells against empty ones, with the filled cell on their left, chained from the first.
  std::multimap<std::pair<int, int>, std::pair<int, int>> next;
  for (int i = 0; i < columns; ++i)
    for (int j = 0; j < rows; ++j) {
      if (!filled(i, j)) continue;
      if (!filled(i, j - 1)) next.emplace(std::pair(i, j), std::pair(i + 1, j));
      if (!filled(i + 1, j)) next.emplace(std::pair(i + 1, j), std::pair(i + 1, j + 1));
      if (!filled(i, j + 1)) next.emplace(std::pair(i + 1, j + 1), std::pair(i, j + 1));
      if (!filled(i - 1, j)) next.emplace(std::pair(i, j + 1), std::pair(i, j));
    }
  std::vector<Vector2d> corners;
  const auto start = next.begin()->first;
  for (auto at = start; !next.empty();) {
    const auto edge = next.find(at);
    if (edge == next.end()) break;
    corners.emplace_back(xs[static_cast<size_t>(at.first)], ys[static_cast<size_t>(at.second)]);
    at = edge->second;
    next.erase(edge);
    if (at == start) break;
  }
  return without_straight(corners);
}

}  // namespace

std::vector<Vector2d> Support::outline() const {
  if (!polygon.empty()) return polygon;
  std::vector<Vector2d> corners = union_outline(parts);
  for (Vector2d& corner : corners) corner = map_from_axes() * corner;
  return corners;
}

}  // namespace loci::mapping
