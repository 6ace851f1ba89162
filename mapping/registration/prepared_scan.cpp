#include "mapping/registration/prepared_scan.h"

#include <algorithm>
#include <cmath>

#include "mapping/base/math/cell_index.h"
#include "mapping/registration/parameters.h"

namespace loci::mapping::registration {

FreeSpace::FreeSpace(const Scan& scan, const Isometry3d& level_from_scan) {
  if (scan.origins.empty()) return;
  const size_t step = (scan.origins.size() + kSurfels.max_images - 1) / kSurfels.max_images;
  for (size_t i = 0; i < scan.origins.size(); i += step) {
    images_.emplace_back();
    images_.back().origin = (level_from_scan * scan.origins[i].cast<double>()).cast<float>();
    for (CubeFace& face : images_.back().nearest) face.fill(0.F);
  }
  const Eigen::Isometry3f level = level_from_scan.cast<float>();
  const auto for_rays = [&](const auto& visit) {
    for (const ScanPoint& point : scan.points) {
      if (point.origin_index % step != 0 || point.origin_index >= scan.origins.size()) continue;
      Image& image = images_[point.origin_index / step];
      const Eigen::Vector3f ray = level * point.position - image.origin;
      const float range = ray.norm();
      if (range > 0.F) visit(image.towards(ray), range);
    }
  };
  for_rays([](float& nearest, float range) { nearest = nearest > 0.F ? std::min(nearest, range) : range; });
  size_t rays = 0, hidden = 0;
  for_rays([&](float nearest, float range) {
    ++rays;
    hidden += range > 1.5F * nearest ? 1 : 0;
  });
  hidden_part_ = rays > 0 ? static_cast<double>(hidden) / static_cast<double>(rays) : 0;
  if (images_.size() > 1) stop_at_points_of_others(scan, level);
  erode();
}

float& FreeSpace::Image::towards(const Eigen::Vector3f& direction) {
  const auto [face, pixel] = pixel_of(direction);
  return nearest[static_cast<size_t>(face)][static_cast<size_t>(pixel)];
}

/// A fused point is one origin's only, though others saw it: they did not look through it.
void FreeSpace::stop_at_points_of_others(const Scan& scan, const Eigen::Isometry3f& level) {
  for (const ScanPoint& point : scan.points) {
    if (!point.returned) continue;
    const Eigen::Vector3f position = level * point.position;
    for (Image& image : images_) {
      const Eigen::Vector3f ray = position - image.origin;
      if (float& nearest = image.towards(ray); nearest > 0.F) nearest = std::min(nearest, ray.norm());
    }
  }
}

std::pair<int, int> FreeSpace::pixel_of(const Eigen::Vector3f& direction) {
  int axis = 0;
  const float longest = direction.cwiseAbs().maxCoeff(&axis);
  const auto coordinate = [&](int other) {
    const float value = (direction[other] / longest + 1.F) * 0.5F * static_cast<float>(kSurfels.image_side);
    return std::clamp(static_cast<int>(value), 0, kSurfels.image_side - 1);
  };
  const int face = 2 * axis + (direction[axis] < 0.F ? 1 : 0);
  return {face, coordinate((axis + 1) % 3) * kSurfels.image_side + coordinate((axis + 2) % 3)};
}

/// Sets every pixel with a ray to the nearest range around it: space at edges of objects is not free.
void FreeSpace::erode() {
  for (Image& image : images_) {
    for (CubeFace& face : image.nearest) {
      const CubeFace source = face;
      for (int v = 0; v < kSurfels.image_side; ++v)
        for (int u = 0; u < kSurfels.image_side; ++u) {
          float& nearest = face[static_cast<size_t>(v * kSurfels.image_side + u)];
          if (nearest == 0.F) continue;
          for (int y = std::max(0, v - 1); y <= std::min(kSurfels.image_side - 1, v + 1); ++y)
            for (int x = std::max(0, u - 1); x <= std::min(kSurfels.image_side - 1, u + 1); ++x) {
              const float other = source[static_cast<size_t>(y * kSurfels.image_side + x)];
              if (other > 0.F) nearest = std::min(nearest, other);
            }
        }
    }
  }
}

bool FreeSpace::passed(const Eigen::Vector3f& point, float margin) const {
  return passed(point, Eigen::Vector3f::Zero(), margin);
}

bool FreeSpace::passed(const Eigen::Vector3f& point, const Eigen::Vector3f& normal, float margin) const {
  const bool is_plane = normal.squaredNorm() > 0.5F;
  for (const Image& image : images_) {
    const Eigen::Vector3f ray = point - image.origin;
    const float range = ray.norm();
    const auto [face, pixel] = pixel_of(ray);
    const float nearest = image.nearest[static_cast<size_t>(face)][static_cast<size_t>(pixel)];
    const float beyond = nearest - range - kSurfels.range_margin * nearest;  // Along the ray.
    if (nearest > 0.F && beyond > 0.F &&
        (is_plane ? beyond * std::abs(ray.dot(normal)) / range : beyond) > margin)
      return true;
  }
  return false;
}

namespace {

Isometry3d upright(const Isometry3d& map_from_scan) {
  const Vector3d rpy = rpy_from_rotation(map_from_scan.linear());
  Isometry3d level_from_scan = Isometry3d::Identity();
  if (rpy.head<2>().norm() > 1e-9) level_from_scan.linear() = rotation_from_rpy({rpy.x(), rpy.y(), 0});
  return level_from_scan;
}

Surfels finest_cells(const Scan& scan, const Isometry3d& level_from_scan, double cell) {
  Surfels surfels;
  surfels.cell = cell;
  std::vector<Eigen::Vector3f> origins;
  for (const Eigen::Vector3f& origin : scan.origins)
    origins.push_back((level_from_scan * origin.cast<double>()).cast<float>());
  if (origins.empty()) origins.emplace_back(Eigen::Vector3f::Zero());
  const auto reach = static_cast<float>(cell * (1 << 20));
  const auto usable = [&](const ScanPoint& point) {
    return point.returned && point.position.cwiseAbs().maxCoeff() < reach;  // NaN is not.
  };
  Eigen::AlignedBox3d box;
  for (const ScanPoint& point : scan.points)
    if (usable(point)) box.extend(level_from_scan * point.position.cast<double>());
  if (box.isEmpty()) return surfels;
  surfels.grid = CellGrid(cell_of(box.min(), cell), cell_of(box.max(), cell), cell_of(origins.front(), cell));
  for (const ScanPoint& point : scan.points) {
    if (!usable(point)) continue;
    const Vector3d position = level_from_scan * point.position.cast<double>();
    const Eigen::Vector3i at = cell_of(position, cell);
    if (!surfels.grid.covers(at)) continue;
    const size_t origin = point.origin_index < origins.size() ? point.origin_index : 0;
    surfels.moments[surfels.number_of(at, origins[origin])].add(position);
  }
  return surfels;
}

}  // namespace

PreparedScan prepare(const Scan& scan, const RegistrationOptions& options) {
  PreparedScan prepared;
  prepared.name = scan.name;
  if (options.dof == 3) prepared.level_from_scan = upright(scan.map_from_scan);
  prepared.free_space = FreeSpace(scan, prepared.level_from_scan);
  PlaneFit fit;
  fit.oriented = prepared.free_space.plausible();
  if (!fit.oriented) prepared.free_space = FreeSpace();
  prepared.levels.push_back(finest_cells(scan, prepared.level_from_scan, options.voxel_m));
  while (prepared.coarsest().cell < kSurfels.coarsest_cell_m)
    prepared.levels.push_back(coarser(prepared.coarsest()));
  for (size_t i = 0; i < prepared.levels.size(); ++i) fit_planes(prepared.levels[i], i == 0, fit);
  for (const Moments<3>& moments : prepared.finest().moments)
    prepared.points += static_cast<size_t>(moments.count);
  for (Surfels& level : prepared.levels) level.moments = {};  // Not needed any more.
  prepared.dilated_grid = dilated_grid(prepared.coarsest());
  for (const Eigen::Vector3f& origin : scan.origins)
    prepared.centre += (prepared.level_from_scan * origin.cast<double>()).cast<float>() /
                       static_cast<float>(scan.origins.size());
  return prepared;
}

}  // namespace loci::mapping::registration
