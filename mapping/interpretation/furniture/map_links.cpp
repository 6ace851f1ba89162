#include "mapping/interpretation/furniture/map_links.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "mapping/base/math/math.h"
#include "mapping/base/text/json.h"
#include "mapping/interpretation/furniture/cabinets.h"
#include "mapping/interpretation/furniture/furniture_links.h"
#include "mapping/interpretation/furniture/link_parts.h"
#include "mapping/interpretation/furniture/names.h"
#include "mapping/interpretation/furniture/parameters.h"
#include "mapping/interpretation/furniture/prior_joints.h"
#include "mapping/interpretation/furniture/sliding.h"

namespace loci::mapping {
namespace {

constexpr const char* kRoot = "map";

double rounded(double value) {
  return std::round(value * 1e4) / 1e4;
}

Json json_of(const std::vector<Vector2d>& corners) {
  Json json = Json::array();
  for (const Vector2d& corner : corners) json.push_back({rounded(corner.x()), rounded(corner.y())});
  return json;
}

/// Limits confidences to [0.05, 0.99].
double capped(double confidence) {
  return rounded(std::clamp(confidence, 0.05, 0.99));
}

/// Confidence from the agreement of several scans, 0 to 1.
double agreement_of(size_t scans) {
  return std::min(1.0, (static_cast<double>(scans) - 1) / 3);
}

Isometry3d pose_at(const Vector2d& centre, double z, double yaw) {
  Isometry3d pose = Isometry3d::Identity();
  pose.translation() = Vector3d(centre.x(), centre.y(), z);
  pose.linear() = Eigen::AngleAxisd(yaw, Vector3d::UnitZ()).toRotationMatrix();
  return pose;
}

void add_level(const RecognisedRoom& room, const LevelPlane& plane, const std::string& class_name,
               InterpretedMap& map) {
  const Eigen::Rotation2Dd map_from_room(room.yaw);
  const Vector2d size = plane.extent.size();
  const double middle = class_name == "floor" ? -kFurniture.wall_m / 2 : kFurniture.wall_m / 2;
  add_link(map.world, class_name, class_name, kRoot,
           pose_at(map_from_room * plane.extent.centre(), plane.height, room.yaw),
           {box_part({0, 0, middle}, {size.x(), size.y(), kFurniture.wall_m})});
  const Extent& e = plane.extent;
  SemanticLink link;
  link.class_name = class_name;
  link.confidence =
      capped(0.5 + 0.4 * std::min(1.0, plane.area / 3) + 0.1 * agreement_of(plane.scans.size()));
  link.geometry = {
      {"height", rounded(plane.height)},
      {"outline", json_of({map_from_room * e.min, map_from_room * Vector2d(e.max.x(), e.min.y()),
                           map_from_room * e.max, map_from_room * Vector2d(e.min.x(), e.max.y())})}};
  link.evidence = {{"inliers", plane.inliers},
                   {"scans", plane.scans},
                   {"area_m2", rounded(plane.area)},
                   {"sd_m", rounded(plane.sd)}};
  map.semantics.links[class_name] = std::move(link);
}

/// A wall as boxes around its openings, in its link's axes: side by side along it, each from bottom to top.
std::vector<LinkPart> wall_parts(const VerticalPlane& wall, const std::vector<WallOpening>& openings) {
  std::vector<double> sides = {wall.along_min, wall.along_max};
  for (const WallOpening& opening : openings)
    sides.insert(sides.end(), {opening.along_min, opening.along_max});
  std::ranges::sort(sides);
  std::vector<LinkPart> parts;
  const double along = (wall.along_min + wall.along_max) / 2, height = (wall.bottom + wall.top) / 2;
  const auto add = [&](double from, double to, double bottom, double top) {
    if (top - bottom > kFurniture.min_wall_part_m)
      parts.push_back(box_part({-kFurniture.wall_m / 2, (from + to) / 2 - along, (bottom + top) / 2 - height},
                               {kFurniture.wall_m, to - from, top - bottom}));
  };
  for (size_t i = 0; i + 1 < sides.size(); ++i) {
    const double from = sides[i], to = sides[i + 1], middle = (from + to) / 2;
    if (to - from < kFurniture.min_wall_part_m) continue;
    std::vector<std::pair<double, double>> holes;
    for (const WallOpening& opening : openings)
      if (opening.along_min < middle && middle < opening.along_max)
        holes.emplace_back(opening.bottom, opening.top);
    std::ranges::sort(holes);
    double bottom = wall.bottom;
    for (const auto& [low, high] : holes) {
      add(from, to, bottom, low);
      bottom = std::max(bottom, high);
    }
    add(from, to, bottom, wall.top);
  }
  return parts;
}

Json json_of(const VerticalPlane& wall, const std::vector<WallOpening>& openings) {
  Json json = Json::array();
  for (const WallOpening& opening : openings) {
    const Vector2d middle = wall.at((opening.along_min + opening.along_max) / 2);
    json.push_back(
        {{"kind", opening.doorway ? "doorway" : "window"},
         {"centre", {rounded(middle.x()), rounded(middle.y()), rounded((opening.bottom + opening.top) / 2)}},
         {"width", rounded(opening.along_max - opening.along_min)},
         {"height", rounded(opening.top - opening.bottom)},
         {"seen", rounded(opening.seen)}});
  }
  return json;
}

void add_wall(const VerticalPlane& wall, const std::vector<WallOpening>& openings, const std::string& name,
              InterpretedMap& map) {
  const Vector2d middle = wall.at((wall.along_min + wall.along_max) / 2);
  const double yaw = std::atan2(wall.normal.y(), wall.normal.x());
  add_link(map.world, name, "wall", kRoot, pose_at(middle, (wall.top + wall.bottom) / 2, yaw),
           wall_parts(wall, openings));
  SemanticLink link;
  link.class_name = "wall";
  link.confidence = capped(0.4 + 0.3 * std::min(1.0, wall.area / 3) + 0.2 * (1 - wall.behind) +
                           0.1 * agreement_of(wall.scans.size()));
  Json outline = Json::array();
  const auto corner = [&](double along, double z) {
    const Vector2d at = wall.at(along);
    outline.push_back({rounded(at.x()), rounded(at.y()), rounded(z)});
  };
  corner(wall.along_min, wall.bottom);
  corner(wall.along_max, wall.bottom);
  corner(wall.along_max, wall.top);
  corner(wall.along_min, wall.top);
  link.geometry = {{"normal", {wall.normal.x(), wall.normal.y(), 0.0}},
                   {"offset", rounded(wall.offset)},
                   {"outline", outline}};
  if (!openings.empty()) link.geometry["openings"] = json_of(wall, openings);
  link.evidence = {{"inliers", wall.inliers},
                   {"scans", wall.scans},
                   {"area_m2", rounded(wall.area)},
                   {"sd_m", rounded(wall.sd)},
                   {"seen_behind", rounded(wall.behind)}};
  map.semantics.links[name] = std::move(link);
}

/// The yaw of a support's frame: x points away from its wall; free-standing ones use the axes nearest to the
/// map's.
double frame_yaw(const RecognisedRoom& room, const Support& support) {
  const double quarter = kPi / 2;
  double outward = 0;
  if (support.wall >= 0 && support.wall_distance < 0.5) {
    const Vector2d& normal = room.walls[static_cast<size_t>(support.wall)].normal;
    outward = std::atan2(normal.y(), normal.x());
  }
  return support.yaw + std::round((outward - support.yaw) / quarter) * quarter;
}

double confidence_of(const Support& support, bool free_space) {
  const double coverage = support.observed_area / support.area();
  const auto known = std::count_if(support.edges.begin(), support.edges.end(),
                                   [](EdgeKind kind) { return kind != EdgeKind::unseen; });
  double confidence = 0.35 + 0.35 * std::min(1.0, coverage / 0.6) + 0.05 * static_cast<double>(known) +
                      0.1 * agreement_of(support.scans.size()) - 0.3 * support.pierced_area / support.area();
  if (support.behind_face) confidence = std::min(confidence, 0.6);
  if (!free_space) confidence = std::min(confidence, 0.6);
  return capped(confidence);
}

/// The slab of a polygon as boxes side by side across x; `corners` in the link's axes.
std::vector<LinkPart> strips(const std::vector<Vector2d>& corners, double thickness) {
  double low = 1e9;
  double high = -1e9;
  for (const Vector2d& corner : corners) {
    low = std::min(low, corner.x());
    high = std::max(high, corner.x());
  }
  const int count = std::max(1, static_cast<int>(std::lround((high - low) / kFurniture.strip_m)));
  const double width = (high - low) / count;
  std::vector<LinkPart> parts;
  for (int i = 0; i < count; ++i) {
    const double x = low + (i + 0.5) * width;
    std::vector<double> crossings;
    for (size_t k = 0; k < corners.size(); ++k) {
      const Vector2d& from = corners[k];
      const Vector2d& to = corners[(k + 1) % corners.size()];
      if ((from.x() < x) != (to.x() < x))
        crossings.push_back(from.y() + (to.y() - from.y()) * (x - from.x()) / (to.x() - from.x()));
    }
    std::sort(crossings.begin(), crossings.end());
    for (size_t k = 0; k + 1 < crossings.size(); k += 2)
      parts.push_back(box_part({x, (crossings[k] + crossings[k + 1]) / 2, -thickness / 2},
                               {width, crossings[k + 1] - crossings[k], thickness}));
  }
  return parts;
}

/// The slab of a support in its link's frame, rotated by `yaw`; sets its centre in those axes.
std::vector<LinkPart> slab(const Support& support, double yaw, double thickness, Vector2d& centre) {
  const Eigen::Rotation2Dd link_from_axes(support.yaw - yaw);
  std::vector<Extent> extents;
  Extent all = Extent::empty();
  for (const Extent& part : support.parts) {
    extents.push_back(Extent::empty());
    extents.back().extend(Vector2d(link_from_axes * part.min));
    extents.back().extend(Vector2d(link_from_axes * part.max));
    all.extend(extents.back());
  }
  centre = all.centre();
  if (support.radius > 0)
    return {rod_part({0, 0, -thickness}, Vector3d::Zero(), support.radius, kFurniture.wood_density)};
  std::vector<LinkPart> parts;
  if (!support.polygon.empty()) {
    std::vector<Vector2d> corners;
    for (const Vector2d& corner : support.polygon)
      corners.push_back(Eigen::Rotation2Dd(-yaw) * corner - centre);
    return strips(corners, thickness);
  }
  for (const Extent& extent : extents) {
    const Vector2d middle = extent.centre() - centre;
    parts.push_back(box_part({middle.x(), middle.y(), -thickness / 2},
                             {extent.size().x(), extent.size().y(), thickness}));
  }
  return parts;
}

/// The legs of a table as a link of its own below that of the top, whose centre is at `centre` in axes turned
/// by `yaw`: fronts cut what is in their way out of slabs only.
void add_legs(const Support& table, const std::string& name, double floor_height, double thickness,
              double yaw, const Vector2d& centre, InterpretedMap& map) {
  const Eigen::Rotation2Dd link_from_axes(table.yaw - yaw);
  const double top = -thickness - kCabinets.clearance_m,
               bottom = floor_height - table.height + kCabinets.clearance_m;
  std::vector<LinkPart> parts;
  Json footprints = Json::array();
  size_t inliers = 0;
  for (const auto& [leg, points] : table.legs) {
    inliers += points;
    Extent in_link = Extent::empty();
    in_link.extend(Vector2d(link_from_axes * leg.min));
    in_link.extend(Vector2d(link_from_axes * leg.max));
    const Vector2d middle = in_link.centre() - centre, size = in_link.size();
    parts.push_back(
        box_part({middle.x(), middle.y(), (top + bottom) / 2}, {size.x(), size.y(), top - bottom}));
    const Eigen::Rotation2Dd map_from_axes = table.map_from_axes();
    footprints.push_back(
        json_of({map_from_axes * leg.min, map_from_axes * Vector2d(leg.max.x(), leg.min.y()),
                 map_from_axes * leg.max, map_from_axes * Vector2d(leg.min.x(), leg.max.y())}));
  }
  add_link(map.world, name + "_legs", "legs", name, Isometry3d::Identity(), parts);
  SemanticLink& link = map.semantics.links[name + "_legs"];
  link.class_name = "legs";
  link.confidence = map.semantics.links.at(name).confidence;
  link.geometry = {{"height", rounded(table.height - thickness)}, {"footprints", footprints}};
  link.evidence = {{"inliers", inliers}, {"scans", table.scans}};
}

void add_support(const RecognisedRoom& room, const Support& support, const std::string& name,
                 const InterpretationOptions& options, InterpretedMap& map) {
  const double yaw = frame_yaw(room, support);
  Vector2d centre = Vector2d::Zero();
  const std::vector<LinkPart> parts = slab(support, yaw, options.slab_thickness_m, centre);
  const Isometry3d map_from_link = pose_at(Eigen::Rotation2Dd(yaw) * centre, support.height, yaw);
  add_link(map.world, name, support.class_name, kRoot, map_from_link, parts);
  SemanticLink link;
  link.class_name = support.class_name;
  link.confidence = confidence_of(support, room.free_space);
  link.geometry = {{"height", rounded(support.height)}, {"outline", json_of(support.outline())}};
  Json edges = Json::object();
  constexpr std::array<const char*, 4> kSides = {"x_min", "x_max", "y_min", "y_max"};
  for (size_t i = 0; i < 4; ++i) edges[kSides[i]] = edge_kind_name(support.edges[i]);
  link.evidence = {{"inliers", support.inliers},
                   {"scans", support.scans},
                   {"area_m2", rounded(support.observed_area)},
                   {"outline_area_m2", rounded(support.area())},
                   {"pierced_area_m2", rounded(support.pierced_area)},
                   {"sd_m", rounded(support.sd)},
                   {"axes_yaw_deg", rounded(support.yaw / kDegree)},
                   {"edges", edges},
                   {"extent_from", support.behind_face ? "front and wall" : "surface"},
                   {"shape", support.radius > 0         ? "round"
                             : !support.polygon.empty() ? "polygon"
                             : support.parts.size() > 1 ? "rectangles"
                                                        : "rectangle"},
                   {"class_because", support.reason}};
  if (room.free_space) link.evidence["seen_below"] = rounded(support.seen_below);
  map.semantics.links[name] = std::move(link);
  if (!support.legs.empty())
    add_legs(support, name, room.floor ? room.floor->height : 0, options.slab_thickness_m, yaw, centre, map);
}

}  // namespace

void add_links(const RecognisedRoom& room, const InterpretationOptions& options, InterpretedMap& map) {
  map.world.name = "map";
  map.world.root = kRoot;
  Link root;
  root.name = kRoot;
  map.world.links.push_back(root);
  if (room.floor) add_level(room, *room.floor, "floor", map);
  if (room.ceiling) add_level(room, *room.ceiling, "ceiling", map);
  const auto in_name_order = [](const std::vector<std::string>& names) {
    std::vector<size_t> order(names.size());
    std::iota(order.begin(), order.end(), 0);
    std::sort(order.begin(), order.end(), [&](size_t a, size_t b) { return names[a] < names[b]; });
    return order;
  };
  const std::vector<std::string> walls = wall_names(room);
  for (const size_t i : in_name_order(walls)) add_wall(room.walls[i], room.openings[i], walls[i], map);
  const std::vector<std::string> supports = support_names(room);
  for (const size_t i : in_name_order(supports)) {
    add_support(room, room.supports[i], supports[i], options, map);
    map.whole_supports.push_back(*map.world.find_link(supports[i]));
  }
}

namespace {

/// Returns the new names by those that the fronts had before.
std::map<std::string, std::string> add_named(std::vector<Front> fronts, InterpretedMap& map) {
  std::map<std::string, std::string> names;
  std::map<std::string, int> used;
  for (const size_t i : front_order(fronts, map.room_yaw)) {
    Front& front = fronts[i];
    const std::string before = front.name;
    front.name = fmt::format("{}_{}", front.class_name, ++used[front.class_name]);
    if (!before.empty()) names[before] = front.name;
    map.fronts.push_back(front);
  }
  add_fronts(map.fronts, kRoot, map.world, map.semantics);
  add_cabinets(map.fronts, kRoot, map.world, map.semantics);
  return names;
}

}  // namespace

void add_fronts(const RecognisedRoom& room, std::vector<Front> fronts, InterpretedMap& map) {
  for (Front& front : fronts) set_prior_joint(front);
  pair_sliding_panels(fronts);
  follow_neighbours(fronts);
  map.room_yaw = room.yaw;
  add_named(std::move(fronts), map);
}

std::map<std::string, std::string> replace_fronts(std::vector<Front> fronts, InterpretedMap& map) {
  remove_cabinets(map.world, map.semantics);
  for (const Front& front : map.fronts) remove_front(front.name, map.world, map.semantics);
  map.fronts.clear();
  for (const Link& support : map.whole_supports)  // Other fronts need other room.
    for (Link& link : map.world.links)
      if (link.name == support.name) link = support;
  return add_named(std::move(fronts), map);
}

}  // namespace loci::mapping
