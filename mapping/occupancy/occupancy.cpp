#include "mapping/occupancy/occupancy.h"

#include <fmt/format.h>

#include <sstream>

#include "mapping/base/files.h"
#include "mapping/base/parallel.h"
#include "mapping/occupancy/dense_voxels.h"
#include "mapping/occupancy/scan_rays.h"
#include "mapping/occupancy/scan_tree.h"

namespace loci::mapping {

using octomap::OcTreeKey;
using octomap::point3d;

namespace {

constexpr size_t kCellsMax = size_t{1} << 30;  ///< of a scan; also what the grids of all threads may hold

}  // namespace

struct OccupancyMap::Impl {
  explicit Impl(const OccupancyOptions& o) : options(o), tree(o.resolution_m) {}
  Impl(const OccupancyOptions& o, const occupancy::ScanTree& t) : options(o), tree(t) {}

  OccupancyOptions options;
  occupancy::ScanTree tree;
  std::vector<std::vector<uint8_t>> grids;  ///< one per thread; all zero between insertions
};

void OccupancyOptions::declare(OptionTable& table) {
  table.number("resolution_m", resolution_m, "m", "Edge of a voxel.", 0.005, 1);
  table.number("range_max_m", range_max_m, "m", "Rays are cut there; what lies behind stays unknown.", 0.1,
               100);
}

OccupancyMap::OccupancyMap(const OccupancyOptions& options) : impl_(std::make_unique<Impl>(options)) {
  OccupancyOptions checked = options;
  table_of(checked).validate();
}
OccupancyMap::~OccupancyMap() = default;
OccupancyMap::OccupancyMap(const OccupancyMap& other)
    : impl_(std::make_unique<Impl>(other.impl_->options, other.impl_->tree)) {}
OccupancyMap::OccupancyMap(OccupancyMap&&) noexcept = default;
OccupancyMap& OccupancyMap::operator=(OccupancyMap&&) noexcept = default;

void OccupancyMap::insert(const Scan& scan) {
  using namespace occupancy;
  const int threads = thread_count(impl_->options.threads);
  const occupancy::ScanRays rays =
      occupancy::scan_rays(scan, impl_->tree, impl_->options.range_max_m, threads);
  const size_t cells = rays.box.cells();
  if (cells == 0) return;
  if (cells > kCellsMax)
    throw Error(fmt::format("scan {} spans {} million voxels of {} m", scan.name, cells >> 20,
                            impl_->options.resolution_m),
                {}, "take larger voxels or a shorter range");
  const size_t parts = std::clamp(kCellsMax / cells, size_t{1}, static_cast<size_t>(threads));
  impl_->grids.resize(std::max(parts, impl_->grids.size()));
  std::vector<uint8_t*> grids(parts);
  const size_t count = rays.rays.size();
  parallel_for(parts, static_cast<int>(parts), [&](size_t begin, size_t end) {
    for (size_t part = begin; part < end; ++part) {
      std::vector<uint8_t>& grid = impl_->grids[part];
      if (grid.size() < cells) grid.resize(cells);
      grids[part] = grid.data();
      const size_t first = count * part / parts, last = count * (part + 1) / parts;
      mark_passed(rays, first, last, impl_->tree, grid.data());
      mark_hits(rays, first, last, impl_->tree, grid.data());
    }
  });
  impl_->tree.apply(rays.box, grids, threads);
}

Occupancy OccupancyMap::at(const Vector3d& point) const {
  OcTreeKey key;
  if (!impl_->tree.coordToKeyChecked(point.x(), point.y(), point.z(), key)) return Occupancy::unknown;
  const octomap::OcTreeNode* node = impl_->tree.search(key);
  if (node == nullptr) return Occupancy::unknown;
  return impl_->tree.isNodeOccupied(node) ? Occupancy::occupied : Occupancy::free;
}

double OccupancyMap::resolution() const {
  return impl_->options.resolution_m;
}
const octomap::OcTree& OccupancyMap::tree() const {
  return impl_->tree;
}

Voxels OccupancyMap::voxels() const {
  return occupancy::dense_voxels(impl_->tree, impl_->options.threads);
}

void OccupancyMap::write_bt(const std::filesystem::path& path) const {
  std::ostringstream stream;
  if (!impl_->tree.writeBinaryConst(stream))
    throw Error("the OctoMap cannot be written", {path.string(), 0, {}});
  write_file_atomically(path, stream.str());
}

}  // namespace loci::mapping
