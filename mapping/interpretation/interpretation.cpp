#include "mapping/interpretation/interpretation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "mapping/base/math/cell_index.h"
#include "mapping/base/math/math.h"
#include "mapping/base/stopwatch.h"
#include "mapping/base/text/json.h"
#include "mapping/base/text/text.h"
#include "mapping/interpretation/fronts/fronts.h"
#include "mapping/interpretation/furniture/map_links.h"
#include "mapping/interpretation/supports/legs.h"
#include "mapping/interpretation/surfaces/levelling.h"
#include "mapping/interpretation/surfaces/parameters.h"
#include "mapping/interpretation/surfaces/surface.h"

namespace loci::mapping {
namespace {

/// The height between `lowest` and `highest` at which most normals point up (`up` = 1) or down (-1).
std::optional<double> peak_height(const Surface& surface, double lowest, double highest, float up) {
  std::vector<size_t> histogram(static_cast<size_t>((highest - lowest) / kLevels.height_bin_m) + 1, 0);
  for (const SurfacePoint& point : surface.points) {
    const double z = static_cast<double>(point.position.z());
    if (up * point.normal.z() > 0.94F && z >= lowest && z < highest)
      ++histogram[static_cast<size_t>((z - lowest) / kLevels.height_bin_m)];
  }
  const auto peak = std::max_element(histogram.begin(), histogram.end());
  if (*peak == 0) return std::nullopt;
  return lowest + (static_cast<double>(peak - histogram.begin()) + 0.5) * kLevels.height_bin_m;
}

/// The level plane near a height; unset when too little of it was seen.
std::optional<LevelPlane> level_plane(const Surface& surface, double around, float up, double yaw) {
  LevelPlane plane;
  const Eigen::Rotation2Dd room_from_map(-yaw);
  std::map<uint16_t, std::vector<double>> heights;
  std::vector<double> x, y;
  CellIndex cells;
  for (const SurfacePoint& point : surface.points) {
    const double z = static_cast<double>(point.position.z());
    if (up * point.normal.z() < 0.94F || std::abs(z - around) > 0.035) continue;
    heights[point.scan].push_back(z);
    const Vector2d at = room_from_map * point.position.head<2>().cast<double>();
    x.push_back(at.x());
    y.push_back(at.y());
    cells.insert(cell_of(Vector3d(at.x(), at.y(), 0), kLevels.area_cell_m));
    ++plane.inliers;
  }
  plane.area = static_cast<double>(cells.size()) * kLevels.area_cell_m * kLevels.area_cell_m;
  if (plane.area < kLevels.min_area_m2) return std::nullopt;
  const auto level = level_height(heights, std::max<size_t>(50, plane.inliers / (20 * heights.size())));
  if (!level) return std::nullopt;
  static_cast<LevelHeight&>(plane) = *level;
  plane.extent = {{quantile(x, 0.002), quantile(y, 0.002)}, {quantile(x, 0.998), quantile(y, 0.998)}};
  return plane;
}

/// A motion that puts a level surface at z = 0, and what that surface is.
struct Levelling {
  Isometry3d levelled;
  Ground ground;
};

/// Only a camera's own views tell a floor from a table top; a scanner stands on the floor.
std::optional<Levelling> find_levelling(const ScanSet& scans, const Surface& surface) {
  const bool camera = scans.sensor == kDepthCameraSensor && surface.free_space;
  for (const Vector3d& up : up_hints(scans)) {
    if (const auto levelled = level_by_floor(surface, up))
      return Levelling{*levelled, camera ? ground_of(surface, *levelled) : Ground()};
    const auto top = camera ? level_by_largest_plane(surface, up) : std::nullopt;
    if (!top) continue;
    const Ground ground = ground_of(surface, *top);
    if (!ground.is_floor) return Levelling{*top, ground};
  }
  return std::nullopt;
}

/// Moves what lies at z = 0 to the height of a table top.
void raise_table(const Ground& ground, double assumed_height, Surface& surface, InterpretedMap& map) {
  const double height = ground.floor_height ? -*ground.floor_height : assumed_height;
  const Isometry3d raised(Eigen::Translation3d(0, 0, height));
  transform(surface, raised);
  map.semantics.map_from_input = raised * *map.semantics.map_from_input;
  map.notes.push_back(fmt::format(
      "the largest level surface in view is taken for the top of a table, as {}; {}", ground.because,
      ground.floor_height
          ? fmt::format("the floor is {:.2f} m below", height)
          : fmt::format("its height over the floor is not known, {:.2f} m is assumed (--table-height-m){}",
                        height,
                        ground.certain ? "" : ". If it is the floor, record what stands around it, too")));
}

void level(const ScanSet& scans, const InterpretationOptions& options, Surface& surface,
           InterpretedMap& map) {
  const auto found = find_levelling(scans, surface);
  if (!found) {
    map.notes.push_back("the input is not levelled and no floor was found to level it by: z was taken as up");
    return;
  }
  transform(surface, found->levelled);
  map.semantics.map_from_input = found->levelled;
  if (found->ground.is_floor)
    map.notes.push_back("the input was levelled by its floor; map_from_input holds the motion");
  else
    raise_table(found->ground, options.table_height_m, surface, map);
}

void find_levels(const Surface& surface, RecognisedRoom& room, InterpretedMap& map) {
  if (const auto height = peak_height(surface, -kLevels.floor_reach_m, kLevels.floor_reach_m, 1))
    room.floor = level_plane(surface, *height, 1, room.yaw);
  if (!room.floor) map.notes.push_back("no floor was seen: heights are above z = 0");
  if (const auto height = peak_height(surface, kLevels.min_ceiling_m, 5, -1)) {
    room.ceiling = level_plane(surface, *height, -1, room.yaw);
    if (room.ceiling && room.ceiling->area < 1) room.ceiling.reset();
  }
}

}  // namespace

void InterpretationOptions::declare(OptionTable& table) {
  table.number("min_support_area_m2", min_support_area_m2, "m2",
               "Horizontal surfaces of which less was seen are left out.", 0.005, 10);
  table.number("min_support_side_m", min_support_side_m, "m", "Narrower horizontal surfaces are left out.",
               0.02, 2);
  table.number("max_support_height_m", max_support_height_m, "m", "Higher horizontal surfaces are left out.",
               0.3, 5);
  table.number("min_wall_area_m2", min_wall_area_m2, "m2",
               "Vertical planes of which less was seen are no walls.", 0.05, 50);
  table.number("min_wall_top_m", min_wall_top_m, "m", "Vertical planes that end lower are furniture (§7.4).",
               0.1, 5);
  table.number("plane_tolerance_m", plane_tolerance_m, "m", "How far a point may lie off its plane.", 0.002,
               0.2);
  table.number("slab_thickness_m", slab_thickness_m, "m",
               "Thickness of a support's box in the URDF; it is not measured.", 0.001, 0.5);
  table.number("table_height_m", table_height_m, "m",
               "Height of a table top that fills the view, so that the floor is not seen.", 0.2, 2);
}

InterpretedMap interpret(const ScanSet& scans, const InterpretationOptions& options, Progress& progress) {
  InterpretationOptions checked = options;
  OptionTable table = table_of(checked);
  table.validate({"", 0, "interpret"});
  if (scans.scans.empty()) throw Error("the scan set has no scans", {}, "run loci-map fuse first");
  InterpretedMap map;
  map.configuration = table.to_json();
  Stopwatch watch;
  const auto lap = [&](const std::string& stage) { map.times.push_back({stage, watch.lap()}); };

  PartialProgress gathering(progress, 0, 0.3);
  Surface surface = gather_surface(scans, options.threads, gathering);
  if (surface.points.empty())
    throw Error("no ray of the scan set returned: there is nothing to interpret", {}, "scan the place again");
  lap("surface");
  if (!surface.free_space)
    map.notes.push_back(
        "no free-space evidence: the input is a bare cloud; outlines and classes are less certain");
  if (!scans.levelled) level(scans, options, surface, map);
  if (surface.free_space) remove_bad_scans(scans, surface, map.notes);

  RecognisedRoom room;
  room.free_space = surface.free_space;
  room.yaw = room_yaw(surface);
  find_levels(surface, room, map);
  const double floor_height = room.floor ? room.floor->height : 0;
  progress.check(0.35, "walls");
  WallSearch vertical = find_walls(
      surface, floor_height, room.ceiling ? std::optional(room.ceiling->height) : std::nullopt, options);
  room.yaw = yaw_of_walls(vertical.walls, room.yaw);
  lap("levels and walls");
  PartialProgress supporting(progress, 0.45, 0.7);
  SupportSearch horizontal = find_supports(surface, floor_height, room.yaw, vertical, options, supporting);
  lap("supports");
  PartialProgress fronting(progress, 0.7, 1);
  FrontSearch furniture = find_fronts(surface, floor_height, vertical, options, fronting);
  lap("fronts");
  room.walls = std::move(vertical.walls);
  room.openings = find_openings(surface, room.walls, floor_height, options.threads);
  room.supports = std::move(horizontal.supports);
  for (Support& support : room.supports)
    if (support.class_name == "table") support.legs = find_legs(surface, floor_height, support);
  if (room.walls.empty()) map.notes.push_back("no walls were recognised");
  if (room.supports.empty())
    map.notes.push_back("no supports were recognised: scan counters and tables from above");
  map.notes.insert(map.notes.end(), vertical.notes.begin(), vertical.notes.end());
  map.notes.insert(map.notes.end(), horizontal.notes.begin(), horizontal.notes.end());
  map.notes.insert(map.notes.end(), furniture.notes.begin(), furniture.notes.end());
  add_links(room, options, map);
  map.faces = std::move(furniture.faces);
  map.ribs = std::move(furniture.ribs);
  add_fronts(room, std::move(furniture.fronts), map);
  progress.check(1, "interpreted");
  return map;
}

std::string InterpretedMap::summary() const {
  std::map<std::string, size_t> classes;
  for (const auto& [name, link] : semantics.links) ++classes[link.class_name];
  if (classes.empty()) return "nothing was recognised: no floor, wall or support was seen well enough";
  std::string text;
  for (const auto& [class_name, count] : classes) {
    // "legs" are several as they are.
    const std::string counted_class =
        class_name.ends_with('s') ? fmt::format("{} {}", count, class_name) : counted(count, class_name);
    text += (text.empty() ? "" : ", ") + counted_class;
  }
  return text;
}

Json InterpretedMap::report() const {
  Json links = Json::object();
  for (const auto& [name, link] : semantics.links)
    links[name] = {{"class", link.class_name},
                   {"confidence", link.confidence},
                   {"geometry", link.geometry},
                   {"evidence", link.evidence}};
  Json stages = Json::object();
  for (const StageTime& time : times) stages[time.stage] = time.seconds;
  return {{"links", links}, {"notes", notes}, {"configuration", configuration}, {"seconds", stages}};
}

}  // namespace loci::mapping
