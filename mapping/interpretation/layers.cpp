#include "mapping/interpretation/layers.h"

#include <algorithm>
#include <cmath>

#include "mapping/base/cell_index.h"

namespace loci::mapping {
namespace {

constexpr float kLayerGap = 0.03F;  // m; a wider gap in a column begins another layer
constexpr float kStep = 0.015F;     // m; largest change of height between neighbouring columns
constexpr int kReach = 2;           // columns; neighbours may be that far apart
constexpr int kMinPoints = 2;       // in a layer of a column

struct ColumnPoint {
  uint32_t column;
  float z;
};

std::vector<LayerCell> cells_of(const Surface& surface, double lowest, double highest, double cell) {
  CellIndex columns(1U << 16U);
  std::vector<ColumnPoint> points;
  for (const SurfacePoint& point : surface.points) {
    const float z = point.position.z();
    if (!looks_up(point) || z < static_cast<float>(lowest) || z > static_cast<float>(highest)) continue;
    Eigen::Vector3i at = cell_of(point.position, cell);
    at.z() = 0;
    points.push_back({columns.insert(at), z});
  }
  std::stable_sort(points.begin(), points.end(), [](const ColumnPoint& a, const ColumnPoint& b) {
    return a.column != b.column ? a.column < b.column : a.z < b.z;
  });
  std::vector<LayerCell> cells;
  for (size_t begin = 0; begin < points.size();) {
    size_t end = begin + 1;
    while (end < points.size() && points[end].column == points[begin].column &&
           points[end].z - points[end - 1].z < kLayerGap)
      ++end;
    const Eigen::Vector3i& at = columns.cells()[points[begin].column];
    if (end - begin >= kMinPoints)
      cells.push_back({at.x(), at.y(), points[(begin + end) / 2].z, static_cast<int>(end - begin), -1});
    begin = end;
  }
  return cells;
}

}  // namespace

Layers find_layers(const Surface& surface, double lowest, double highest) {
  Layers layers;
  layers.cells = cells_of(surface, lowest, highest, layers.cell);
  CellIndex columns(layers.cells.size());
  std::vector<std::vector<uint32_t>> in_column;
  for (uint32_t i = 0; i < layers.cells.size(); ++i) {
    const uint32_t column = columns.insert({layers.cells[i].x, layers.cells[i].y, 0});
    if (column == in_column.size()) in_column.emplace_back();
    in_column[column].push_back(i);
  }
  for (uint32_t seed = 0; seed < layers.cells.size(); ++seed) {
    if (layers.cells[seed].component >= 0) continue;
    const int number = static_cast<int>(layers.components.size());
    std::vector<uint32_t> piece = {seed};
    layers.cells[seed].component = number;
    for (size_t next = 0; next < piece.size(); ++next) {
      const LayerCell from = layers.cells[piece[next]];
      for (int dx = -kReach; dx <= kReach; ++dx)
        for (int dy = -kReach; dy <= kReach; ++dy) {
          const uint32_t column = columns.find({from.x + dx, from.y + dy, 0});
          if (column == CellIndex::kNone) continue;
          for (const uint32_t i : in_column[column]) {
            LayerCell& to = layers.cells[i];
            if (to.component >= 0 || std::abs(to.height - from.height) > kStep) continue;
            to.component = number;
            piece.push_back(i);
          }
        }
    }
    layers.components.push_back(std::move(piece));
  }
  std::stable_sort(layers.components.begin(), layers.components.end(),
                   [](const auto& a, const auto& b) { return a.size() > b.size(); });
  for (size_t number = 0; number < layers.components.size(); ++number)
    for (const uint32_t i : layers.components[number]) layers.cells[i].component = static_cast<int>(number);
  return layers;
}

}  // namespace loci::mapping
