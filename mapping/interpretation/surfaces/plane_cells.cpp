#include "mapping/interpretation/surfaces/plane_cells.h"

#include <algorithm>

#include "mapping/interpretation/surfaces/parameters.h"

namespace loci::mapping {

PlaneCells::PlaneCells(const VerticalPlane& plane, double cell, double on_plane, double crossed)
    : plane_(plane),
      normal_(plane.normal.cast<float>()),
      direction_(plane.direction().cast<float>()),
      offset_(static_cast<float>(plane.offset)),
      on_plane_(static_cast<float>(on_plane)),
      crossed_(static_cast<float>(crossed)),
      cell_(cell),
      columns_(static_cast<size_t>(plane.length() / cell) + 1),
      rows_(static_cast<size_t>((plane.top - plane.bottom) / cell) + 1),
      hits_(columns_ * rows_, 0),
      passes_(columns_ * rows_, 0),
      seen_above_(columns_, 0),
      over_(columns_, 0) {}

void PlaneCells::add(const Surface& surface, size_t step) {
  for (size_t k = 0; k < surface.points.size(); k += step) {
    const SurfacePoint& point = surface.points[k];
    add_ray(surface.origins[point.origin], point.position, true);
  }
  for (size_t k = 0; k < surface.free_ends.size(); k += step)
    add_ray(surface.origins[surface.free_ends[k].second], surface.free_ends[k].first, false);
}

void PlaneCells::add_ray(const Eigen::Vector3f& from, const Eigen::Vector3f& to, bool returned) {
  const float start = normal_.dot(from.head<2>()) - offset_;
  const float end = normal_.dot(to.head<2>()) - offset_;
  if (start < on_plane_ || end > on_plane_) return;
  const bool on = end > -on_plane_;
  if (on && !returned) return;
  if (!on && end > -crossed_) return;
  const Eigen::Vector3f at = on ? to : Eigen::Vector3f(from + (to - from) * (start / (start - end)));
  const double along = static_cast<double>(direction_.dot(at.head<2>())) - plane_.along_min;
  if (along < 0 || along > plane_.length()) return;
  const auto column = static_cast<size_t>(along / cell_);
  const double z = static_cast<double>(at.z());
  if (z >= plane_.bottom && z <= plane_.top) {
    ++(on ? hits_ : passes_)[static_cast<size_t>((z - plane_.bottom) / cell_) * columns_ + column];
  } else if (z > plane_.top + kWalls.above_top_m && z < plane_.top + kWalls.max_above_top_m) {
    ++seen_above_[column];
    if (!on && returned) ++over_[column];
  }
}

RayEvidence PlaneCells::evidence() const {
  const auto fraction = [](const std::vector<int>& counts) {
    const auto many = std::count_if(counts.begin(), counts.end(), [](int n) { return n >= kWalls.min_rays; });
    return static_cast<double>(many) / static_cast<double>(counts.size());
  };
  double crossed = 0;
  double seen = 0;
  for (size_t cell = 0; cell < hits_.size(); ++cell) {
    const bool through = passes_[cell] >= kWalls.min_rays && passes_[cell] > hits_[cell];
    crossed += through;
    seen += through || hits_[cell] > 0;
  }
  return {fraction(seen_above_), fraction(over_), seen > 0 ? crossed / seen : 0};
}

}  // namespace loci::mapping
