#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <numeric>

#include "mapping/interpretation/map_links.h"

namespace loci::mapping {
namespace {

enum Side { north, east, south, west };
constexpr std::array<const char*, 4> kSideNames = {"north", "east", "south", "west"};

/// Position along a side, clockwise seen from above, in the room's axes.
double clockwise(Side side, const Vector2d& point) {
  return side == north ? point.x() : side == east ? -point.y() : side == south ? -point.x() : point.y();
}

Side side_of(const Vector2d& outward) {
  if (std::abs(outward.y()) >= std::abs(outward.x())) return outward.y() > 0 ? north : south;
  return outward.x() > 0 ? east : west;
}

struct Rank {
  int side = 0;
  double along = 0;
  double depth = 0;  ///< distance from the side: breaks ties between what stands one behind the other

  auto operator<=>(const Rank&) const = default;
};

/// The numbers 0, 1, … sorted by rank.
std::vector<size_t> in_order(const std::vector<Rank>& ranks) {
  std::vector<size_t> order(ranks.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) { return ranks[a] < ranks[b]; });
  return order;
}

}  // namespace

std::vector<std::string> wall_names(const RecognisedRoom& room) {
  const Eigen::Rotation2Dd room_from_map(-room.yaw);
  std::vector<Rank> ranks;
  for (const VerticalPlane& wall : room.walls) {
    const Side side = side_of(-(room_from_map * wall.normal));
    const Vector2d middle = room_from_map * wall.at((wall.along_min + wall.along_max) / 2);
    ranks.push_back({side, clockwise(side, middle), 0});
  }
  std::vector<std::string> names(room.walls.size());
  std::map<int, int> used;
  for (const size_t i : in_order(ranks)) {
    const int number = ++used[ranks[i].side];
    const char* side = kSideNames[static_cast<size_t>(ranks[i].side)];
    names[i] = number > 1 ? fmt::format("wall_{}_{}", side, number) : fmt::format("wall_{}", side);
  }
  return names;
}

std::vector<std::string> support_names(const RecognisedRoom& room) {
  // The box of the room, from what was recognised.
  const Eigen::Rotation2Dd room_from_map(-room.yaw);
  Vector2d low = Vector2d::Constant(1e9);
  Vector2d high = Vector2d::Constant(-1e9);
  const auto cover = [&](const Vector2d& map_point) {
    low = low.cwiseMin(room_from_map * map_point);
    high = high.cwiseMax(room_from_map * map_point);
  };
  for (const VerticalPlane& wall : room.walls)
    for (const double along : {wall.along_min, wall.along_max}) cover(wall.at(along));
  for (const Support& support : room.supports)
    for (const Vector2d& corner : support.outline()) cover(corner);
  std::vector<Rank> ranks;
  for (const Support& support : room.supports) {
    const Vector2d centre = room_from_map * (support.map_from_axes() * support.parts.front().centre());
    const std::array<double, 4> distances = {high.y() - centre.y(), high.x() - centre.x(),
                                             centre.y() - low.y(), centre.x() - low.x()};
    auto nearest =
        static_cast<Side>(std::min_element(distances.begin(), distances.end()) - distances.begin());
    if (support.wall >= 0 && support.wall_distance < 0.25)
      nearest = side_of(-(room_from_map * room.walls[static_cast<size_t>(support.wall)].normal));
    ranks.push_back({nearest, clockwise(nearest, centre), distances[static_cast<size_t>(nearest)]});
  }
  std::vector<std::string> names(room.supports.size());
  std::map<std::string, int> used;
  for (const size_t i : in_order(ranks)) {
    const std::string& class_name = room.supports[i].class_name;
    names[i] = fmt::format("{}_{}", class_name, ++used[class_name]);
  }
  return names;
}

}  // namespace loci::mapping
