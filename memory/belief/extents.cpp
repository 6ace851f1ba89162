#include "memory/belief/extents.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

#include "memory/belief/parameters.h"

namespace loci::memory::belief {
namespace {

/// What one view shows of the extents.
struct MeasuredView {
  Vector3d size = {};
  std::array<bool, 3> seen = {true, true, true};  ///< else a lower bound
  double weight = 1;
  TimeNs time = 0;
  bool partial = false;
};

std::optional<MeasuredView> measured(const StoredView& view) {
  const auto found = std::ranges::find(view.descriptors, "extents", &Descriptor::kind);
  if (found == view.descriptors.end() || found->values.size() < 3) return std::nullopt;
  const std::vector<float>& values = found->values;
  MeasuredView one{.weight = view.weight, .time = view.time, .partial = view.partial};
  for (int axis = 0; axis < 3; ++axis) {
    const auto i = static_cast<size_t>(axis);
    one.size[axis] = values[i];
    one.seen[i] = !view.partial && (values.size() < 6 || values[i + 3] != 0);
  }
  if (one.size.x() < one.size.y()) {
    std::swap(one.size.x(), one.size.y());
    std::swap(one.seen[0], one.seen[1]);
  }
  return one;
}

/// Of what the present views lack of the extents before: a quarter at a time, so that a side which only some
/// views show is not forgotten, and a neighbour that one took in is.
constexpr double kShrinkGain = 0.25;

double resize_noise(double height) {
  return kParameters.max_resize_deviations *
         (kParameters.extent_noise_m + kParameters.extent_noise_per_size * height);
}

/// Views of an object that stood otherwise do not count: a bottle that lies is as high as it is wide.
void keep_present_pose(std::vector<MeasuredView>& views) {
  const auto older = [](const MeasuredView& a, const MeasuredView& b) {
    return std::pair(!a.partial, a.time) < std::pair(!b.partial, b.time);
  };
  const double height = std::ranges::max_element(views, older)->size.z();
  const double noise = resize_noise(height);
  std::erase_if(views, [&](const MeasuredView& view) {
    const double higher = view.size.z() - height;
    return view.partial ? higher > noise : std::abs(higher) > noise;
  });
}

/// The largest value that a quarter of the views reaches: they miss a side more often than they take a
/// neighbour in.
double upper_quartile(std::vector<std::pair<double, double>> values) {
  std::ranges::sort(values);
  const double all = std::accumulate(values.begin(), values.end(), 0.0,
                                     [](double sum, const auto& one) { return sum + one.second; });
  double below = 0;
  for (const auto& [value, weight] : values)
    if ((below += weight) >= 0.75 * all) return value;
  return values.back().first;
}

}  // namespace

std::optional<Vector3d> extents_of(const ProtoObject& object, const std::optional<Vector3d>& before) {
  std::vector<MeasuredView> views;
  for (const StoredView& view : object.views)
    if (const auto one = measured(view)) views.push_back(*one);
  if (views.empty()) return std::nullopt;
  keep_present_pose(views);
  Vector3d extents = Vector3d::Zero();
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<std::pair<double, double>> seen;
    for (const MeasuredView& view : views) {
      if (view.seen[static_cast<size_t>(axis)]) seen.emplace_back(view.size[axis], view.weight);
      extents[axis] = std::max(extents[axis], view.size[axis]);
    }
    if (!seen.empty()) extents[axis] = upper_quartile(std::move(seen));
  }
  if (!before || std::abs(before->z() - extents.z()) > resize_noise(extents.z())) return extents;
  return extents.cwiseMax(*before + kShrinkGain * (extents - *before));
}

}  // namespace loci::memory::belief
