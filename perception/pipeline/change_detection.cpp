#include "perception/pipeline/flow.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "perception/cas/graph.h"

namespace loci::perception {

void ChangeOptions::declare(OptionTable& table) {
  table.integer("bits", bits, "", "Maximum number of different bits of the 64-bit perceptual hashes.", 0, 64);
  table.number("color", color, "", "Maximum mean colour distance (CIE Lab).", 0, 300);
  table.number("place_m", place_m, "m", "Maximum distance between the positions in the map.", 0, 1000);
  table.number("growth", growth, "", "Maximum ratio of the widths and of the heights of the image regions.",
               1, 100);
  table.integer("remembered", remembered, "", "Number of views that are stored during a run.", 1, 1000000);
}

std::optional<ChangeDetector::Appearance> ChangeDetector::appearance_of(const types::Cluster& cluster) {
  for (const auto& roi : cluster.hypotheses.filter<types::ImageROI>()) {
    if (!roi.phash.is_set() || !roi.cell_colors.is_set() || !roi.roi.is_set()) continue;
    if (!cluster.centroid.is_set()) return std::nullopt;
    const types::Rect region = roi.roi.get();
    return Appearance{static_cast<uint64_t>(roi.phash.get()),        roi.cell_colors.to_vector(),
                      types::from<Vector3d>(cluster.centroid.get()), static_cast<double>(region.x.get()),
                      static_cast<double>(region.y.get()),           static_cast<double>(region.width.get()),
                      static_cast<double>(region.height.get())};
  }
  return std::nullopt;
}

std::optional<int> ChangeDetector::difference(const Appearance& now, const Appearance& then) const {
  const int bits = std::popcount(now.hash ^ then.hash);
  if (bits > options_.bits || now.colors.size() != then.colors.size()) return std::nullopt;
  if ((now.place - then.place).norm() > options_.place_m) return std::nullopt;
  const auto as_large = [&](double a, double b) {
    return a <= b * options_.growth && b <= a * options_.growth;
  };
  if (!as_large(now.width, then.width) || !as_large(now.height, then.height)) return std::nullopt;
  double sum = 0;
  for (size_t i = 0; i < now.colors.size(); ++i)
    sum += std::abs(static_cast<double>(now.colors[i]) - static_cast<double>(then.colors[i]));
  const double cells = static_cast<double>(now.colors.size()) / 3;
  if (sum > options_.color * cells) return std::nullopt;
  return bits;
}

bool ChangeDetector::reuse(const types::Cluster& cluster) const {
  const std::optional<Appearance> now = appearance_of(cluster);
  if (!now) return false;
  const StoredView* best = nullptr;
  int least = 0;
  for (const StoredView& view : views_)
    if (const auto bits = difference(*now, view.appearance); bits && (best == nullptr || *bits < least)) {
      best = &view;
      least = *bits;
    }
  if (best == nullptr) return false;
  if (best->annotations.empty()) return true;
  const size_t known = cluster.cas().size();
  cas::Copier copy(*best->cas, cluster.cas());
  for (const types::Annotation& annotation : best->annotations) {
    const types::Annotation taken(copy(annotation));
    taken.taken_from.set(best->frame);
    cluster.annotations.push_back(taken);
  }
  // Regions of the image move with the cluster.
  const double sx = now->width / best->appearance.width, sy = now->height / best->appearance.height;
  for (auto id = static_cast<uint32_t>(known + 1); id <= cluster.cas().size(); ++id)
    if (const auto rect = types::try_as<types::Rect>(cas::FeatureStructure(&cluster.cas(), id))) {
      const auto whole = [](double value) { return static_cast<int32_t>(std::lround(value)); };
      rect->x.set(whole(now->x + (rect->x.get() - best->appearance.x) * sx));
      rect->y.set(whole(now->y + (rect->y.get() - best->appearance.y) * sy));
      rect->width.set(whole(rect->width.get() * sx));
      rect->height.set(whole(rect->height.get() * sy));
    }
  return true;
}

void ChangeDetector::store(const types::Cluster& cluster, size_t known, int64_t frame) {
  const std::optional<Appearance> appearance = appearance_of(cluster);
  if (!appearance || appearance->width <= 0 || appearance->height <= 0) return;
  std::vector<cas::FeatureStructure> added;
  for (const types::Annotation& annotation : cluster.annotations)
    if (annotation.structure().id() > known) added.push_back(annotation);
  for (const cas::FeatureStructure& each : cas::reachable_from(added))
    if (each.id() <= known) return;
  StoredView view{*appearance, frame, std::make_unique<cas::Cas>(cluster.cas().shared_type_system()), {}};
  cas::Copier copy(cluster.cas(), *view.cas);
  for (const cas::FeatureStructure& each : added) view.annotations.emplace_back(copy(each));
  views_.push_front(std::move(view));
  if (views_.size() > static_cast<size_t>(options_.remembered)) views_.pop_back();
}

}  // namespace loci::perception
