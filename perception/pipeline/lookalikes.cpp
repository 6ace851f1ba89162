#include "perception/pipeline/lookalikes.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "perception/cas/copy.h"
#include "perception/cas/graph.h"

namespace loci::perception {

void AlikeOptions::declare(OptionTable& table) {
  table.integer("bits", bits, "", "Perceptual hashes of 64 bits may differ in so many.", 0, 64);
  table.number("color", color, "", "Colours may differ by so much (CIE Lab, on average).", 0, 300);
  table.number("place_m", place_m, "m", "It may have moved by so much in the map.", 0, 1000);
  table.number("growth", growth, "", "Its image may be so many times as wide or high, or less.", 1, 100);
  table.integer("remembered", remembered, "", "So many looks are remembered.", 1, 1000000);
}

std::optional<Lookalikes::Look> Lookalikes::look_at(const types::Cluster& cluster) {
  for (const auto& roi : cluster.hypotheses.filter<types::ImageROI>()) {
    if (!roi.phash.is_set() || !roi.cell_colors.is_set() || !roi.roi.is_set()) continue;
    if (!cluster.centroid.is_set()) return std::nullopt;
    const types::Rect region = roi.roi.get();
    return Look{static_cast<uint64_t>(roi.phash.get()),        roi.cell_colors.to_vector(),
                types::from<Vector3d>(cluster.centroid.get()), static_cast<double>(region.x.get()),
                static_cast<double>(region.y.get()),           static_cast<double>(region.width.get()),
                static_cast<double>(region.height.get())};
  }
  return std::nullopt;
}

std::optional<int> Lookalikes::difference(const Look& now, const Look& then) const {
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

bool Lookalikes::take_over(const types::Cluster& cluster) const {
  const std::optional<Look> now = look_at(cluster);
  if (!now) return false;
  const Entry* best = nullptr;
  int least = 0;
  for (const Entry& entry : entries_)
    if (const auto bits = difference(*now, entry.look); bits && (best == nullptr || *bits < least)) {
      best = &entry;
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
  const double sx = now->width / best->look.width, sy = now->height / best->look.height;
  for (auto id = static_cast<uint32_t>(known + 1); id <= cluster.cas().size(); ++id)
    if (const auto rect = types::try_as<types::Rect>(cas::FeatureStructure(&cluster.cas(), id))) {
      const auto whole = [](double value) { return static_cast<int32_t>(std::lround(value)); };
      rect->x.set(whole(now->x + (rect->x.get() - best->look.x) * sx));
      rect->y.set(whole(now->y + (rect->y.get() - best->look.y) * sy));
      rect->width.set(whole(rect->width.get() * sx));
      rect->height.set(whole(rect->height.get() * sy));
    }
  return true;
}

void Lookalikes::remember(const types::Cluster& cluster, size_t known, int64_t frame) {
  const std::optional<Look> look = look_at(cluster);
  if (!look || look->width <= 0 || look->height <= 0) return;
  std::vector<cas::FeatureStructure> said;
  for (const types::Annotation& annotation : cluster.annotations)
    if (annotation.structure().id() > known) said.push_back(annotation);
  for (const cas::FeatureStructure& each : cas::reachable_from(said))
    if (each.id() <= known) return;
  Entry entry{*look, frame, std::make_unique<cas::Cas>(cluster.cas().shared_type_system()), {}};
  cas::Copier copy(cluster.cas(), *entry.cas);
  for (const cas::FeatureStructure& each : said) entry.annotations.emplace_back(copy(each));
  entries_.push_front(std::move(entry));
  if (entries_.size() > static_cast<size_t>(options_.remembered)) entries_.pop_back();
}

}  // namespace loci::perception
