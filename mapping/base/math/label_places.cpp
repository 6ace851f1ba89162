#include "mapping/base/math/label_places.h"

#include <algorithm>
#include <limits>

namespace loci {
namespace {

using Eigen::AlignedBox2d;
using Eigen::Vector2d;

AlignedBox2d box_at(const Vector2d& middle, const Vector2d& size) {
  return {middle - size / 2, middle + size / 2};
}

/// How far a rectangle's corners are from the edges of an outline; 0 or less where it reaches over them.
double room_around(const Polygon& outline, const AlignedBox2d& label) {
  double room = std::numeric_limits<double>::infinity();
  for (const auto corner :
       {AlignedBox2d::BottomLeft, AlignedBox2d::BottomRight, AlignedBox2d::TopLeft, AlignedBox2d::TopRight}) {
    if (!contains(outline, label.corner(corner))) return 0;
    room = std::min(room, distance_to_edge(outline, label.corner(corner)));
  }
  // Corners inside leave the edges of an inner corner, which has one of its own within the rectangle.
  const bool pierced = std::ranges::any_of(outline, [&](const Vector2d& at) { return label.contains(at); });
  return pierced ? 0 : room;
}

}  // namespace

bool LabelPlaces::is_free(const AlignedBox2d& label) const {
  return std::ranges::none_of(taken_, [&](const AlignedBox2d& other) { return other.intersects(label); });
}

std::optional<Vector2d> LabelPlaces::innermost(const Polygon& outline, const Vector2d& size,
                                               const Vector2d& inside) const {
  constexpr int kSteps = 40;           // middles that are tried along each side of the box around the outline
  constexpr double kOffMiddle = 0.05;  // room that is given up to be nearer to the middle
  AlignedBox2d extent;
  for (const Vector2d& corner : outline) extent.extend(corner);
  std::optional<Vector2d> best;
  double most = -std::numeric_limits<double>::infinity();
  for (int row = 1; row < kSteps; ++row)
    for (int column = 1; column < kSteps; ++column) {
      const Vector2d middle =
          extent.min() + extent.sizes().cwiseProduct(Vector2d(column, row) / static_cast<double>(kSteps));
      const double room = is_free(box_at(middle, size)) ? room_around(outline, box_at(middle, inside)) : 0;
      const double value = room - kOffMiddle * (middle - extent.center()).norm();
      if (room <= 0 || value <= most) continue;
      most = value;
      best = middle;
    }
  return best;
}

std::optional<Vector2d> LabelPlaces::take_inside(const Polygon& outline, const Vector2d& size) {
  const std::optional<Vector2d> middle = innermost(outline, size, size);
  return middle ? take_first({*middle}, size) : std::nullopt;
}

std::optional<Vector2d> LabelPlaces::take_about(const Polygon& outline, const Vector2d& size) {
  const std::optional<Vector2d> middle = innermost(outline, size, Vector2d::Zero());
  return middle ? take_first({*middle}, size) : std::nullopt;
}

std::optional<Vector2d> LabelPlaces::take_first(const std::vector<Vector2d>& middles, const Vector2d& size) {
  for (const Vector2d& middle : middles) {
    const AlignedBox2d label = box_at(middle, size);
    if (!is_free(label)) continue;
    taken_.push_back(label);
    return middle;
  }
  return std::nullopt;
}

}  // namespace loci
