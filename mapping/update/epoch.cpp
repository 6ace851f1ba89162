#include "mapping/update/epoch.h"

#include <algorithm>
#include <cmath>

#include "mapping/base/math/cell_index.h"
#include "mapping/base/parallel.h"
#include "mapping/update/parameters.h"

namespace loci::mapping {

using registration::CellGrid;
using registration::Surfels;

RegistrationOptions epoch_options(double cell_m) {
  RegistrationOptions options;
  options.voxel_m = cell_m;
  options.min_overlap = kEpochs.min_overlap;
  options.max_conflict = kEpochs.max_conflict;
  return options;
}

Epoch::Epoch(const ScanSet& scans, double cell_m, int threads) {
  cloud_.name = "epoch";
  rays_.resize(scans.scans.size());
  parallel_each(scans.scans.size(), threads, [&](size_t i) {
    rays_[i] = registration::FreeSpace(scans.scans[i], scans.scans[i].map_from_scan);
  });
  for (size_t i = 0; i < scans.scans.size(); ++i) {
    const Scan& scan = scans.scans[i];
    names_.push_back(scan.name);
    const size_t first_origin = cloud_.origins.size();
    for (const Eigen::Vector3f& origin : scan.origins)
      cloud_.origins.push_back((scan.map_from_scan * origin.cast<double>()).cast<float>());
    for (ScanPoint point : scan.points) {
      if (!point.returned) continue;
      point.position = (scan.map_from_scan * point.position.cast<double>()).cast<float>();
      point.origin_index = static_cast<uint16_t>(
          first_origin +
          std::min<size_t>(point.origin_index, scan.origins.empty() ? 0 : scan.origins.size() - 1));
      cloud_.points.push_back(point);
      scan_.push_back(static_cast<uint16_t>(i));
    }
  }
  number_points(cell_m, threads);
}

void Epoch::number_points(double cell_m, int threads) {
  prepared_ = registration::prepare(cloud_, epoch_options(cell_m));
  surfel_.resize(cloud_.points.size());
  parallel_for(cloud_.points.size(), threads, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i)
      surfel_[i] = surface().grid.find(cell_of(cloud_.points[i].position, cell_m));
  });
}

void Epoch::drop_flying_points(int threads) {
  std::vector<uint32_t> points(surface().size(), 0);
  for (const uint32_t i : surfel_)
    if (i != CellGrid::kNone) ++points[i];
  std::vector<uint8_t> solid(surface().size(), 0);
  parallel_for(surface().size(), threads, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i)
      solid[i] =
          points[i] >= kEpochs.min_points && !passed(surface().position[i], surface().normal[i]) ? 1 : 0;
  });
  size_t kept = 0;
  for (size_t i = 0; i < cloud_.points.size(); ++i) {
    if (surfel_[i] == CellGrid::kNone || solid[surfel_[i]] == 0) continue;
    cloud_.points[kept] = cloud_.points[i];
    scan_[kept++] = scan_[i];
  }
  cloud_.points.resize(kept);
  scan_.resize(kept);
  number_points(surface().cell, threads);
}

uint32_t same_surfel(const Surfels& surface, const Eigen::Vector3f& position, const Eigen::Vector3f& normal) {
  const uint32_t i = surface.nearest(position, normal, 1.5F * static_cast<float>(surface.cell));
  if (i == CellGrid::kNone || surface.weight[i] <= 0.F) return i;
  const float offset = surface.normal[i].dot(position - surface.position[i]);
  return std::abs(offset) < static_cast<float>(kEpochs.max_offset_m) ? i : CellGrid::kNone;
}

bool Epoch::passed(size_t scan, const Eigen::Vector3f& position) const {
  return rays_[scan].passed(position, kEpochs.free_margin_m);
}

bool Epoch::passed(const Eigen::Vector3f& position, const Eigen::Vector3f& normal) const {
  return std::ranges::any_of(
      rays_, [&](const auto& rays) { return rays.passed(position, normal, kEpochs.free_margin_m); });
}

SurfaceState Epoch::state_of(const Eigen::Vector3f& position, const Eigen::Vector3f& normal) const {
  if (same_surfel(surface(), position, normal) != CellGrid::kNone) return SurfaceState::same;
  if (surface().near(position)) return SurfaceState::other;
  return passed(position, normal) ? SurfaceState::free : SurfaceState::unknown;
}

Scan Epoch::part(const std::vector<uint8_t>& chosen) const {
  Scan scan;
  scan.name = "part";
  scan.origins = cloud_.origins;
  for (size_t i = 0; i < cloud_.points.size(); ++i)
    if (surfel_[i] != CellGrid::kNone && chosen[surfel_[i]] != 0) scan.points.push_back(cloud_.points[i]);
  return scan;
}

registration::PreparedScan Epoch::prepared_part(const std::vector<uint8_t>& chosen, double cell_m) const {
  return registration::prepare(part(chosen), epoch_options(cell_m));
}

std::vector<size_t> Epoch::points_by_scan(const std::vector<uint8_t>& chosen) const {
  std::vector<size_t> counts(names_.size(), 0);
  for (size_t i = 0; i < cloud_.points.size(); ++i)
    if (surfel_[i] != CellGrid::kNone && chosen[surfel_[i]] != 0) ++counts[scan_[i]];
  return counts;
}

}  // namespace loci::mapping
