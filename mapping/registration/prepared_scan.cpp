#include "mapping/registration/prepared_scan.h"

#include <cmath>

#include "mapping/base/cell_index.h"

namespace loci::mapping::registration {
namespace {

/// The coarsest cells are at least so wide: what a search in steps of this width can find.
constexpr double kCoarsestCell = 0.16;
/// A scan of which more is hidden from its origins was not taken from there.
constexpr double kHiddenMax = 0.25;

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
  fit.oriented = prepared.free_space.known() && prepared.free_space.hidden_part() < kHiddenMax;
  if (!fit.oriented) prepared.free_space = FreeSpace();
  prepared.levels.push_back(finest_cells(scan, prepared.level_from_scan, options.voxel_m));
  while (prepared.coarsest().cell < kCoarsestCell) prepared.levels.push_back(coarser(prepared.coarsest()));
  for (size_t i = 0; i < prepared.levels.size(); ++i) fit_planes(prepared.levels[i], i == 0, fit);
  for (const Moments& moments : prepared.finest().moments)
    prepared.points += static_cast<size_t>(moments.count);
  for (Surfels& level : prepared.levels) level.moments = {};  // They have served.
  prepared.net = wide_net(prepared.coarsest());
  for (const Eigen::Vector3f& origin : scan.origins)
    prepared.centre += (prepared.level_from_scan * origin.cast<double>()).cast<float>() /
                       static_cast<float>(scan.origins.size());
  return prepared;
}

}  // namespace loci::mapping::registration
