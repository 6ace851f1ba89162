#include "mapping/interpretation/furniture/names.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <opencv2/imgproc.hpp>
#include <set>
#include <tuple>

#include "mapping/base/math/polygon.h"
#include "mapping/base/math/vector_json.h"
#include "mapping/base/text/json.h"
#include "mapping/interpretation/furniture/parameters.h"
#include "mapping/world/furniture_classes.h"

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
  double depth = 0;  ///< distance from the side: breaks ties

  auto operator<=>(const Rank&) const = default;
};

/// The numbers 0, 1, … sorted by rank.
std::vector<size_t> in_order(const std::vector<Rank>& ranks) {
  std::vector<size_t> order(ranks.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) { return ranks[a] < ranks[b]; });
  return order;
}

/// Position of a front for numbering.
struct FrontRank {
  size_t front = 0;
  Side side = north;
  double row = 0;     ///< distance from the middle of the room towards that side
  double column = 0;  ///< along the side, clockwise, of the first edge
  double top = 0;
};

FrontRank rank_of(const Front& front, size_t number, double yaw) {
  const Eigen::Rotation2Dd room_from_map(-yaw);
  const Vector2d outward = -(room_from_map * front.normal.head<2>());
  const Vector2d centre = room_from_map * front.centre.head<2>();
  const Side side = side_of(outward);
  return {number, side, outward.dot(centre), clockwise(side, centre) - front.width / 2,
          front.centre.z() + front.height / 2};
}

/// Sets values that differ little from the next smaller one to the smallest of their group.
void group_values(std::vector<FrontRank>& ranks, double FrontRank::*value, double tolerance) {
  std::vector<size_t> order(ranks.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](size_t a, size_t b) { return ranks[a].*value < ranks[b].*value; });
  double first = 0;
  double last = -1e9;
  for (const size_t i : order) {
    double& own = ranks[i].*value;
    if (own - last > tolerance) first = own;
    last = own;
    own = first;
  }
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
  const Eigen::Rotation2Dd room_from_map(-room.yaw);
  Extent box = Extent::empty();
  const auto cover = [&](const Vector2d& map_point) { box.extend(Vector2d(room_from_map * map_point)); };
  for (const VerticalPlane& wall : room.walls)
    for (const double along : {wall.along_min, wall.along_max}) cover(wall.at(along));
  for (const Support& support : room.supports)
    for (const Vector2d& corner : support.outline()) cover(corner);
  std::vector<Rank> ranks;
  for (const Support& support : room.supports) {
    const Vector2d centre = room_from_map * (support.map_from_axes() * support.parts.front().centre());
    const std::array<double, 4> distances = {box.max.y() - centre.y(), box.max.x() - centre.x(),
                                             centre.y() - box.min.y(), centre.x() - box.min.x()};
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

std::vector<size_t> front_order(const std::vector<Front>& fronts, double room_yaw) {
  std::vector<size_t> order;
  for (const Side side : {north, east, south, west}) {
    std::vector<FrontRank> ranks;
    for (size_t i = 0; i < fronts.size(); ++i)
      if (const FrontRank rank = rank_of(fronts[i], i, room_yaw); rank.side == side) ranks.push_back(rank);
    group_values(ranks, &FrontRank::row, kFurniture.row_m);
    group_values(ranks, &FrontRank::column, kFurniture.column_m);
    std::stable_sort(ranks.begin(), ranks.end(), [](const FrontRank& a, const FrontRank& b) {
      return std::tuple(-a.row, a.column, -a.top) < std::tuple(-b.row, b.column, -b.top);
    });
    for (const FrontRank& rank : ranks) order.push_back(rank.front);
  }
  return order;
}

namespace {

enum class Family { none, wall, level, support, front };

Family family_of(const std::string& class_name) {
  if (class_name == "wall") return Family::wall;
  if (class_name == "floor" || class_name == "ceiling") return Family::level;
  if (is_support_class(class_name)) return Family::support;
  for (const char* name : {"front", "drawer", "door", "flap"})
    if (class_name == name) return Family::front;
  return Family::none;
}

/// A link with a name of its own; its parts (handles, sides) are named after it.
struct NamedLink {
  std::string name;  ///< base name
  const SemanticLink* link = nullptr;
  Family family = Family::none;
};

/// The name without the suffix of a part of a front or table.
std::string base_of(const std::string& name) {
  for (const char* part : {"_front", "_handle", "_knob", "_left", "_right", "_back", "_bottom", "_legs"})
    if (name.ends_with(part)) return name.substr(0, name.size() - std::string(part).size());
  return name;
}

std::string base_of(const std::string& name, const SemanticMap& semantics) {
  const auto link = semantics.links.find(name);
  if (link != semantics.links.end()) {
    const Family family = family_of(link->second.class_name);
    if (family != Family::none && family != Family::front) return name;
  }
  return base_of(name);
}

std::vector<NamedLink> named_links(const SemanticMap& semantics) {
  std::vector<NamedLink> links;
  for (const auto& [name, link] : semantics.links) {
    const Family family = family_of(link.class_name);
    if (family == Family::none) continue;
    const std::string base = base_of(name, semantics);
    const bool known =
        std::any_of(links.begin(), links.end(), [&](const NamedLink& t) { return t.name == base; });
    if (!known) links.push_back({base, &link, family});
  }
  return links;
}

/// 1 for equal planes that share all of the shorter one's length.
double wall_similarity(const Json& a, const Json& b) {
  const Vector3d normal = vector_from_json(a.at("normal"));
  if (normal.dot(vector_from_json(b.at("normal"))) < 0.985) return 0;
  const Vector3d direction(-normal.y(), normal.x(), 0);
  const auto span = [&](const Json& wall, Vector3d& middle) {
    std::pair<double, double> range{1e9, -1e9};
    middle.setZero();
    for (const Json& corner : wall.at("outline")) {
      const Vector3d at = vector_from_json(corner);
      range = {std::min(range.first, direction.dot(at)), std::max(range.second, direction.dot(at))};
      middle += at / static_cast<double>(wall.at("outline").size());
    }
    return range;
  };
  Vector3d middle_a, middle_b;
  const auto range_a = span(a, middle_a);
  const auto range_b = span(b, middle_b);
  const double shared = std::min(range_a.second, range_b.second) - std::max(range_a.first, range_b.first);
  const double shorter = std::min(range_a.second - range_a.first, range_b.second - range_b.first);
  const double apart = std::abs(normal.dot(middle_b - middle_a));
  return apart > 0.2 || shorter <= 0 ? 0 : std::max(0.0, shared / shorter) * (1 - apart / 0.2);
}

/// The convex hull of an outline.
Polygon hull_of(const Json& outline) {
  std::vector<cv::Point2f> corners, hull;
  for (const Json& corner : outline)
    corners.emplace_back(corner.at(0).get<float>(), corner.at(1).get<float>());
  cv::convexHull(corners, hull);
  Polygon polygon;
  for (const cv::Point2f& corner : hull)
    polygon.emplace_back(static_cast<double>(corner.x), static_cast<double>(corner.y));
  return polygon;
}

/// Intersection over union of the convex hulls, less where heights differ.
double support_similarity(const Json& a, const Json& b) {
  const double apart = std::abs(a.at("height").get<double>() - b.at("height").get<double>());
  if (apart > 0.1) return 0;
  const Polygon hull_a = hull_of(a.at("outline")), hull_b = hull_of(b.at("outline"));
  const double common = shared_area(hull_a, hull_b);
  const double both = area_of(hull_a) + area_of(hull_b) - common;
  const double overlap = both > 0 ? common / both : 0;
  return overlap < 0.2 ? 0 : overlap * (1 - apart / 0.2);
}

/// 1 for fronts in the same place, 0 when they are more than half a front apart.
double front_similarity(const Json& a, const Json& b) {
  if (vector_from_json(a.at("normal")).dot(vector_from_json(b.at("normal"))) < 0.9) return 0;
  const auto smallest = [](const Json& front) {
    return std::min(front.at("width").get<double>(), front.at("height").get<double>());
  };
  const double far = std::clamp((smallest(a) + smallest(b)) / 4, 0.05, 0.3);
  return std::max(0.0,
                  1 - (vector_from_json(a.at("centre")) - vector_from_json(b.at("centre"))).norm() / far);
}

double similarity(const NamedLink& a, const NamedLink& b) {
  if (a.family != b.family) return 0;
  const Json& first = a.link->geometry;
  const Json& second = b.link->geometry;
  try {
    if (a.family == Family::wall) return wall_similarity(first, second);
    if (a.family == Family::front) return front_similarity(first, second);
    if (a.family == Family::level) return a.link->class_name == b.link->class_name ? 1 : 0;
    return support_similarity(first, second);
  } catch (const Json::exception&) {
    return 0;  // maps written by people may lack geometry
  }
}

/// A name of the same class with an unused number.
std::string free_name(const std::string& name, const std::set<std::string>& used) {
  if (!used.contains(name)) return name;
  const size_t digits = name.find_last_not_of("0123456789");
  const std::string stem = digits + 1 < name.size() ? name.substr(0, digits + 1) : name + "_";
  for (int number = 1;; ++number) {
    std::string candidate = stem + std::to_string(number);
    if (!used.contains(candidate)) return candidate;
  }
}

void rename(World& world, SemanticMap& semantics, const std::map<std::string, std::string>& new_names) {
  const SemanticMap before = semantics;
  const auto renamed = [&](const std::string& link) {
    const auto base = new_names.find(base_of(link, before));
    return base == new_names.end() ? link : base->second + link.substr(base->first.size());
  };
  std::map<std::string, std::string> joints;
  for (Joint& joint : world.joints) {
    const std::string old = joint.name;
    if (joint.name == joint.child + "_joint") joint.name = renamed(joint.child) + "_joint";
    joints[old] = joint.name;
    joint.parent = renamed(joint.parent);
    joint.child = renamed(joint.child);
  }
  for (Joint& joint : world.joints)
    if (joint.mimic && joints.contains(joint.mimic->joint)) joint.mimic->joint = joints[joint.mimic->joint];
  for (Link& link : world.links) link.name = renamed(link.name);
  world.root = renamed(world.root);
  semantics.links.clear();
  for (const auto& [name, link] : before.links) {
    SemanticLink& now = semantics.links[renamed(name)] = link;
    if (!now.extra.contains("fronts")) continue;
    for (Json& front : now.extra["fronts"])
      if (const auto base = new_names.find(front.get<std::string>()); base != new_names.end())
        front = base->second;
  }
}

/// Pairs of similar links, most similar first, each in at most one pair.
std::map<size_t, size_t> matches(const std::vector<NamedLink>& now, const std::vector<NamedLink>& then) {
  struct Pair {
    double score;
    size_t now, then;
  };
  std::vector<Pair> pairs;
  for (size_t i = 0; i < now.size(); ++i)
    for (size_t j = 0; j < then.size(); ++j)
      if (const double score = similarity(now[i], then[j]); score > 0) pairs.push_back({score, i, j});
  std::stable_sort(pairs.begin(), pairs.end(),
                   [](const Pair& a, const Pair& b) { return a.score > b.score; });
  std::map<size_t, size_t> result;
  std::set<size_t> taken;
  for (const Pair& pair : pairs) {
    if (result.contains(pair.now) || taken.contains(pair.then)) continue;
    result[pair.now] = pair.then;
    taken.insert(pair.then);
  }
  return result;
}

}  // namespace

std::string NameTransfer::summary() const {
  return fmt::format("{} names kept, {} new, {} gone", kept, added.size(), vanished.size());
}

NameTransfer transfer_names(World& world, SemanticMap& semantics, const SemanticMap& older) {
  const std::vector<NamedLink> now = named_links(semantics);
  const std::vector<NamedLink> then = named_links(older);
  const std::map<size_t, size_t> pairs = matches(now, then);
  NameTransfer result;
  std::set<std::string> used;
  std::set<std::string> vanished;
  for (const NamedLink& link : then) {
    used.insert(link.name);
    vanished.insert(link.name);
  }
  std::map<std::string, std::string> new_names;
  for (const auto& [i, j] : pairs) {
    new_names[now[i].name] = then[j].name;
    vanished.erase(then[j].name);
    ++result.kept;
  }
  for (size_t i = 0; i < now.size(); ++i) {
    if (pairs.contains(i)) continue;
    const std::string name = free_name(now[i].name, used);
    used.insert(name);
    new_names[now[i].name] = name;
    result.added.push_back(name);
  }
  result.vanished.assign(vanished.begin(), vanished.end());
  rename(world, semantics, new_names);
  for (auto& [name, link] : semantics.links) {
    const auto before = older.links.find(name);
    if (before == older.links.end()) continue;
    if (link.aliases.empty()) link.aliases = before->second.aliases;
    if (link.appliance.empty()) link.appliance = before->second.appliance;
  }
  return result;
}

}  // namespace loci::mapping
