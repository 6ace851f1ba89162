#include "nbv/costmaps.h"

#include <algorithm>
#include <cmath>

#include "mapping/base/math/math.h"
#include "mapping/base/parallel.h"

namespace loci::nbv {

double CostmapStack::yaw(size_t layer) const {
  return 2 * kPi * static_cast<double>(layer) / static_cast<double>(layers.size());
}

VisibilityKernel::VisibilityKernel(double opening, double min_distance, double max_distance, double yaw,
                                   double cell) {
  const int reach = static_cast<int>(std::floor(max_distance / cell));
  const auto sees = [&](int x, int y) {
    const double distance = cell * std::hypot(x, y);
    if (distance < min_distance || distance > max_distance) return false;
    const double bearing = std::atan2(-y, -x);  // Of the voxel, which is at (0, 0), from the cell.
    return std::abs(std::remainder(bearing - yaw, 2 * kPi)) <= opening / 2 + 1e-9;
  };
  for (int y = -reach; y <= reach; ++y)
    for (int x = -reach; x <= reach; ++x) {
      if (!sees(x, y)) continue;
      if (!runs_.empty() && runs_.back().y == y && runs_.back().x_end == x)
        ++runs_.back().x_end;
      else
        runs_.push_back({y, x, x + 1});
    }
}

CostmapStack vote(const mapping::FloorGrid& floor, const std::vector<int>& votes,
                  const std::vector<VisibilityKernel>& kernels, int threads) {
  CostmapStack stack;
  stack.layers.resize(kernels.size());
  const auto width = static_cast<size_t>(floor.width) + 1;
  parallel_for(kernels.size(), threads, [&](size_t begin, size_t end) {
    for (size_t layer = begin; layer < end; ++layer) {
      // A run adds at its begin and subtracts behind its end; a sum over each row then gives the map.
      std::vector<int> steps(width * static_cast<size_t>(floor.height), 0);
      for (int y = 0; y < floor.height; ++y)
        for (int x = 0; x < floor.width; ++x) {
          const int count = votes[floor.index(x, y)];
          if (count == 0) continue;
          for (const VisibilityKernel::Run& run : kernels[layer].runs()) {
            const int row = y + run.y;
            if (row < 0 || row >= floor.height) continue;
            int* line = steps.data() + width * static_cast<size_t>(row);
            line[std::clamp(x + run.x_begin, 0, floor.width)] += count;
            line[std::clamp(x + run.x_end, 0, floor.width)] -= count;
          }
        }
      std::vector<float>& map = stack.layers[layer];
      map.resize(floor.cells());
      for (int y = 0; y < floor.height; ++y) {
        int sum = 0;
        for (int x = 0; x < floor.width; ++x) {
          sum += steps[width * static_cast<size_t>(y) + static_cast<size_t>(x)];
          map[floor.index(x, y)] = static_cast<float>(sum);
        }
      }
    }
  });
  return stack;
}

}  // namespace loci::nbv
