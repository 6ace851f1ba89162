#include "nbv/reachability.h"

#include <algorithm>
#include <cmath>
#include <queue>

#include "mapping/base/math/math.h"

namespace loci::nbv {
namespace {

/// Cells nearer than `radius` to an obstacle's cell, centre to centre.
std::vector<uint8_t> dilated(const mapping::FloorGrid& floor, double radius) {
  const int reach = static_cast<int>(std::ceil(radius / floor.cell));
  std::vector<uint8_t> blocked(floor.cells(), 0);
  for (int y = 0; y < floor.height; ++y)
    for (int x = 0; x < floor.width; ++x) {
      if (floor.obstacle[floor.index(x, y)] == 0) continue;
      for (int dy = -reach; dy <= reach; ++dy)
        for (int dx = -reach; dx <= reach; ++dx)
          if (floor.cell * std::hypot(dx, dy) < radius && floor.contains(x + dx, y + dy))
            blocked[floor.index(x + dx, y + dy)] = 1;
    }
  return blocked;
}

/// Cells that the robot's centre may pass.
std::vector<uint8_t> passable_cells(const mapping::FloorGrid& floor, const mapping::PlanarPose& robot,
                                    double robot_radius, double blind_radius) {
  std::vector<uint8_t> passable = dilated(floor, robot_radius);
  const Vector2d here(robot.x, robot.y);
  for (int y = 0; y < floor.height; ++y)
    for (int x = 0; x < floor.width; ++x) {
      const size_t at = floor.index(x, y);
      const double distance = (floor.center(x, y) - here).norm();
      const bool floor_there =
          floor.seen[at] != 0 || (distance < blind_radius && floor.open[at] != 0) || distance < robot_radius;
      const bool blocked = distance < robot_radius ? floor.obstacle[at] != 0 : passable[at] != 0;
      passable[at] = floor_there && !blocked ? 1 : 0;
    }
  return passable;
}

}  // namespace

Reachability shortest_paths(const mapping::FloorGrid& floor, const mapping::PlanarPose& robot,
                            double robot_radius, double blind_radius) {
  Reachability reach;
  reach.distance.assign(floor.cells(), Reachability::kUnreachable);
  reach.parent.assign(floor.cells(), -1);
  reach.roomy.assign(floor.cells(), 0);
  if (floor.cells() == 0) return reach;
  // After a single scan what is known ends where the robot stands: it may be a hair's breadth outside.
  const Eigen::Vector2i start = floor.cell_of({robot.x, robot.y})
                                    .cwiseMax(0)
                                    .cwiseMin(Eigen::Vector2i(floor.width - 1, floor.height - 1));
  if ((floor.center(start.x(), start.y()) - Vector2d(robot.x, robot.y)).norm() > robot_radius) return reach;
  const double anywhere_in_cell = floor.cell * std::sqrt(0.5);
  reach.roomy = dilated(floor, robot_radius + anywhere_in_cell);
  for (uint8_t& cell : reach.roomy) cell = cell == 0 ? 1 : 0;
  std::vector<uint8_t> passable = passable_cells(floor, robot, robot_radius, blind_radius);
  passable[floor.index(start.x(), start.y())] = reach.roomy[floor.index(start.x(), start.y())] = 1;
  const auto free = [&](int x, int y) { return floor.contains(x, y) && passable[floor.index(x, y)] != 0; };

  using Entry = std::pair<float, int32_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  const auto first = static_cast<int32_t>(floor.index(start.x(), start.y()));
  reach.distance[static_cast<size_t>(first)] = 0;
  open.emplace(0.F, first);
  while (!open.empty()) {
    const auto [distance, cell] = open.top();
    open.pop();
    if (distance > reach.distance[static_cast<size_t>(cell)]) continue;
    const int x = cell % floor.width, y = cell / floor.width;
    for (int dy = -1; dy <= 1; ++dy)
      for (int dx = -1; dx <= 1; ++dx) {
        if (!free(x + dx, y + dy) || !free(x + dx, y) || !free(x, y + dy)) continue;
        const size_t next = floor.index(x + dx, y + dy);
        const float length = distance + static_cast<float>(floor.cell * std::hypot(dx, dy));
        if (length >= reach.distance[next]) continue;
        reach.distance[next] = length;
        reach.parent[next] = cell;
        open.emplace(length, static_cast<int32_t>(next));
      }
  }
  return reach;
}

std::vector<mapping::PlanarPose> path_to(const mapping::FloorGrid& floor, const Reachability& reach,
                                         const mapping::PlanarPose& goal) {
  const Eigen::Vector2i end = floor.cell_of({goal.x, goal.y});
  if (!floor.contains(end.x(), end.y())) return {};
  auto cell = static_cast<int32_t>(floor.index(end.x(), end.y()));
  if (reach.distance[static_cast<size_t>(cell)] == Reachability::kUnreachable) return {};
  std::vector<Vector2d> points;
  for (; cell >= 0; cell = reach.parent[static_cast<size_t>(cell)])
    points.push_back(floor.center(cell % floor.width, cell / floor.width));
  std::reverse(points.begin(), points.end());
  std::vector<mapping::PlanarPose> path;
  for (size_t i = 0; i + 1 < points.size(); ++i) {
    const Vector2d along = points[i + 1] - points[i];
    const double yaw = std::atan2(along.y(), along.x());
    if (path.empty() || std::abs(std::remainder(yaw - path.back().yaw, 2 * kPi)) > 1e-6)
      path.push_back({points[i].x(), points[i].y(), yaw});
  }
  path.push_back(goal);
  return path;
}

}  // namespace loci::nbv
