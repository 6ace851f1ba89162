#include "nbv/frontier.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "mapping/base/parallel.h"

namespace loci::nbv {
namespace {

/// The layer above which at most one of 500 occupied voxels lies.
int top_layer(const mapping::Voxels& voxels, int threads) {
  const auto layer_size = static_cast<size_t>(voxels.size.x()) * static_cast<size_t>(voxels.size.y());
  std::vector<size_t> occupied(static_cast<size_t>(voxels.size.z()), 0);
  parallel_for(occupied.size(), threads, [&](size_t begin, size_t end) {
    for (size_t z = begin; z < end; ++z)
      for (size_t i = 0; i < layer_size; ++i)
        occupied[z] += voxels.states[z * layer_size + i] == mapping::Occupancy::occupied ? 1 : 0;
  });
  const size_t total = std::accumulate(occupied.begin(), occupied.end(), size_t{0});
  size_t above = 0;
  int top = voxels.size.z() - 1;
  while (top > 0 && (above += occupied[static_cast<size_t>(top)]) * 500 <= total) --top;
  return top;
}

/// States of a row of voxels, given the four rows beside it. Returns the number of frontier voxels. Without
/// branches: eight or more voxels at a time.
size_t mark_frontier(const mapping::Occupancy* here, const std::array<const mapping::Occupancy*, 4>& beside,
                     ViewVoxel* states, size_t width) {
  const auto unknown = [](mapping::Occupancy state) { return state == mapping::Occupancy::unknown; };
  const auto mark = [&](size_t x, bool before, bool after) {
    const bool window = before | after | unknown(beside[0][x]) | unknown(beside[1][x]) |
                        unknown(beside[2][x]) | unknown(beside[3][x]);
    const bool frontier = (here[x] == mapping::Occupancy::free) & window;
    states[x] = frontier ? ViewVoxel::frontier : static_cast<ViewVoxel>(here[x]);
  };
  mark(0, true, width == 1 || unknown(here[1]));
  for (size_t x = 1; x + 1 < width; ++x) mark(x, unknown(here[x - 1]), unknown(here[x + 1]));
  if (width > 1) mark(width - 1, unknown(here[width - 2]), true);
  return static_cast<size_t>(std::count(states, states + width, ViewVoxel::frontier));
}

/// Outside a region no frontier counts: its voxels are free like others.
void forget_outside(const mapping::Voxels& voxels, const mapping::FloorRegion& within, ViewVoxels& view,
                    std::vector<size_t>& counts) {
  for (int y = 0; y < voxels.size.y(); ++y)
    for (int x = 0; x < voxels.size.x(); ++x) {
      if (within.contains(voxels.center({x, y, 0}).head<2>())) continue;
      for (int z = 0; z < voxels.size.z(); ++z) {
        ViewVoxel& state = view.states[voxels.index({x, y, z})];
        if (state != ViewVoxel::frontier) continue;
        state = ViewVoxel::free;
        --counts[static_cast<size_t>(z)];
      }
    }
}

}  // namespace

ViewVoxels find_frontier(const mapping::Voxels& voxels, int threads, const mapping::FloorRegion& within) {
  ViewVoxels result;
  result.states.resize(voxels.states.size());
  if (voxels.states.empty()) return result;
  const int top = top_layer(voxels, threads);
  const int bottom = std::max(0, voxels.voxel_of({0, 0, 0}).z());
  const auto width = static_cast<size_t>(voxels.size.x());
  const std::vector<mapping::Occupancy> outside(width, mapping::Occupancy::unknown);
  std::vector<size_t> counts(static_cast<size_t>(voxels.size.z()), 0);
  parallel_for(counts.size(), threads, [&](size_t begin, size_t end) {
    const auto row = [&](int y, int z) {
      const bool inside = y >= 0 && z >= 0 && y < voxels.size.y() && z < voxels.size.z();
      return inside ? voxels.states.data() + voxels.index({0, y, z}) : outside.data();
    };
    for (int z = static_cast<int>(begin); z < static_cast<int>(end); ++z)
      for (int y = 0; y < voxels.size.y(); ++y) {
        const mapping::Occupancy* here = row(y, z);
        ViewVoxel* states = result.states.data() + voxels.index({0, y, z});
        if (z > top || z < bottom) {
          std::transform(here, here + width, states,
                         [](mapping::Occupancy o) { return static_cast<ViewVoxel>(o); });
          continue;
        }
        // Beyond bottom and top nothing counts as unknown: the row itself takes the place of that neighbour.
        counts[static_cast<size_t>(z)] += mark_frontier(
            here,
            {row(y - 1, z), row(y + 1, z), z > bottom ? row(y, z - 1) : here, z < top ? row(y, z + 1) : here},
            states, width);
      }
  });
  if (!within.everywhere()) forget_outside(voxels, within, result, counts);
  result.frontier = std::accumulate(counts.begin(), counts.end(), size_t{0});
  return result;
}

}  // namespace loci::nbv
