#include "nbv/fringe.h"

#include <array>
#include <cmath>
#include <numeric>

#include "mapping/base/parallel.h"

namespace loci {
namespace {

/// The layer above which at most one of 500 occupied voxels lies.
int top_layer(const Voxels& voxels, int threads) {
  const auto layer_size = static_cast<size_t>(voxels.size.x()) * static_cast<size_t>(voxels.size.y());
  std::vector<size_t> occupied(static_cast<size_t>(voxels.size.z()), 0);
  parallel_for(occupied.size(), threads, [&](size_t begin, size_t end) {
    for (size_t z = begin; z < end; ++z)
      for (size_t i = 0; i < layer_size; ++i)
        occupied[z] += voxels.states[z * layer_size + i] == Occupancy::occupied ? 1 : 0;
  });
  const size_t total = std::accumulate(occupied.begin(), occupied.end(), size_t{0});
  size_t above = 0;
  int top = voxels.size.z() - 1;
  while (top > 0 && (above += occupied[static_cast<size_t>(top)]) * 500 <= total) --top;
  return top;
}

}  // namespace

ViewVoxels find_fringe(const Voxels& voxels, int threads) {
  ViewVoxels result;
  result.states.resize(voxels.states.size());
  if (voxels.states.empty()) return result;
  const int top = top_layer(voxels, threads);
  const int bottom = std::max(0, voxels.voxel_of({0, 0, 0}).z());
  std::vector<size_t> counts(static_cast<size_t>(voxels.size.z()), 0);
  const std::array<Eigen::Vector3i, 6> neighbours = {
      Eigen::Vector3i{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  parallel_for(counts.size(), threads, [&](size_t begin, size_t end) {
    for (int z = static_cast<int>(begin); z < static_cast<int>(end); ++z)
      for (int y = 0; y < voxels.size.y(); ++y)
        for (int x = 0; x < voxels.size.x(); ++x) {
          const Eigen::Vector3i voxel(x, y, z);
          const size_t at = voxels.index(voxel);
          result.states[at] = static_cast<ViewVoxel>(voxels.states[at]);
          if (voxels.states[at] != Occupancy::free || z > top || z < bottom) continue;
          for (const Eigen::Vector3i& step : neighbours) {
            const Eigen::Vector3i next = voxel + step;
            if (next.z() < bottom || next.z() > top || voxels.at(next) != Occupancy::unknown) continue;
            result.states[at] = ViewVoxel::fringe;
            ++counts[static_cast<size_t>(z)];
            break;
          }
        }
  });
  result.fringe = std::accumulate(counts.begin(), counts.end(), size_t{0});
  return result;
}

}  // namespace loci
