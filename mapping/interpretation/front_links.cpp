#include "mapping/interpretation/front_links.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "mapping/articulation/articulation.h"
#include "mapping/interpretation/furniture_links.h"

namespace loci::mapping {
namespace {

constexpr const char* kRoot = "map";
constexpr double kMinSure = 0.5;     // of the type of a joint, without which none is claimed
constexpr double kSameRow = 0.3;     // m; faces less far behind each other are one row of furniture
constexpr double kSameColumn = 0.1;  // m between the left edges of fronts of one column

struct Place {
  size_t front = 0;
  int side = 0;       ///< clockwise from north
  double row = 0;     ///< distance from the middle of the room towards that side
  double column = 0;  ///< along the side, clockwise, of the edge that comes first
  double top = 0;
};

Place place_of(const Front& front, size_t number, double yaw) {
  const Eigen::Rotation2Dd room_from_map(-yaw);
  const Vector2d outward = -(room_from_map * front.normal.head<2>());
  const Vector2d centre = room_from_map * front.centre.head<2>();
  const bool y = std::abs(outward.y()) >= std::abs(outward.x());
  const int side = y ? (outward.y() > 0 ? 0 : 2) : (outward.x() > 0 ? 1 : 3);
  const double along = side == 0   ? centre.x()
                       : side == 1 ? -centre.y()
                       : side == 2 ? -centre.x()
                                   : centre.y();
  return {number, side, outward.dot(centre), along - front.width / 2, front.centre.z() + front.height / 2};
}

/// Makes values that differ little from the next smaller one equal to the smallest of them.
template <class Value>
void level(std::vector<Place>& places, Value value, double tolerance) {
  std::vector<size_t> order(places.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](size_t a, size_t b) { return value(places[a]) < value(places[b]); });
  double first = 0;
  double last = -1e9;
  for (const size_t i : order) {
    double& own = value(places[i]);
    if (own - last > tolerance) first = own;
    last = own;
    own = first;
  }
}

/// The numbers of the fronts in the order of their names.
std::vector<size_t> in_order(const std::vector<Front>& fronts, double yaw) {
  std::vector<size_t> order;
  for (int side = 0; side < 4; ++side) {
    std::vector<Place> places;
    for (size_t i = 0; i < fronts.size(); ++i) {
      const Place place = place_of(fronts[i], i, yaw);
      if (place.side == side) places.push_back(place);
    }
    level(
        places, [](Place& place) -> double& { return place.row; }, kSameRow);
    level(
        places, [](Place& place) -> double& { return place.column; }, kSameColumn);
    std::stable_sort(places.begin(), places.end(), [](const Place& a, const Place& b) {
      return std::tuple(-a.row, a.column, -a.top) < std::tuple(-b.row, b.column, -b.top);
    });
    for (const Place& place : places) order.push_back(place.front);
  }
  return order;
}

void add_named(std::vector<Front> fronts, InterpretedMap& map) {
  std::map<std::string, int> used;
  for (const size_t i : in_order(fronts, map.room_yaw)) {
    Front& front = fronts[i];
    front.name = fmt::format("{}_{}", front.class_name, ++used[front.class_name]);
    add_front(front, kRoot, map.world, map.semantics);
    map.fronts.push_back(front);
  }
}

}  // namespace

void add_fronts(const RecognisedRoom& room, std::vector<Front> fronts, InterpretedMap& map) {
  for (Front& front : fronts) {
    const JointEstimate joint = joint_prior(front);
    const bool sure = joint.probabilities[static_cast<size_t>(joint.type)] >= kMinSure;
    if (!front.fixture && !sure) continue;
    front.joint = joint;
    front.class_name = front_class(front, joint);
  }
  map.room_yaw = room.yaw;
  add_named(std::move(fronts), map);
}

void replace_fronts(std::vector<Front> fronts, InterpretedMap& map) {
  for (const Front& front : map.fronts) remove_front(front.name, map.world, map.semantics);
  map.fronts.clear();
  add_named(std::move(fronts), map);
}

}  // namespace loci::mapping
