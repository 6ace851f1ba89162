#include "mapping/interpretation/interpretation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "mapping/base/cell_index.h"
#include "mapping/base/json.h"
#include "mapping/base/quantile.h"
#include "mapping/base/stopwatch.h"
#include "mapping/interpretation/front_links.h"
#include "mapping/interpretation/fronts.h"
#include "mapping/interpretation/levelling.h"
#include "mapping/interpretation/map_links.h"
#include "mapping/interpretation/scan_checks.h"

namespace loci::mapping {
namespace {

constexpr double kFloorReach = 0.25;  // m; a levelled input has its floor within this of z = 0
constexpr double kCeilingLow = 1.9;   // m
constexpr double kMinArea = 0.3;      // m² of floor
constexpr double kAreaCell = 0.05;    // m

/// The height between `lowest` and `highest` at which most points look up (`up` = 1) or down (-1).
std::optional<double> peak_height(const Surface& surface, double lowest, double highest, float up) {
  constexpr double kBin = 0.01;
  std::vector<size_t> histogram(static_cast<size_t>((highest - lowest) / kBin) + 1, 0);
  for (const SurfacePoint& point : surface.points) {
    const double z = static_cast<double>(point.position.z());
    if (up * point.normal.z() > 0.94F && z >= lowest && z < highest)
      ++histogram[static_cast<size_t>((z - lowest) / kBin)];
  }
  const auto peak = std::max_element(histogram.begin(), histogram.end());
  if (*peak == 0) return std::nullopt;
  return lowest + (static_cast<double>(peak - histogram.begin()) + 0.5) * kBin;
}

/// The level plane around a height; unset when too little of it was seen.
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
    cells.insert(cell_of(Vector3d(at.x(), at.y(), 0), kAreaCell));
    ++plane.inliers;
  }
  plane.area = static_cast<double>(cells.size()) * kAreaCell * kAreaCell;
  if (plane.area < kMinArea) return std::nullopt;
  std::vector<double> medians;
  for (const auto& [scan, values] : heights) {
    if (values.size() < std::max<size_t>(50, plane.inliers / (20 * heights.size()))) continue;
    medians.push_back(median(values));
    plane.scans.push_back(scan);
  }
  if (medians.empty()) return std::nullopt;
  plane.height = median(medians);
  double squares = 0;
  for (const double value : medians) squares += (value - plane.height) * (value - plane.height);
  plane.sd = std::sqrt(squares / static_cast<double>(medians.size()));
  plane.extent = {{quantile(x, 0.002), quantile(y, 0.002)}, {quantile(x, 0.998), quantile(y, 0.998)}};
  return plane;
}

void level(const ScanSet& scans, Surface& surface, InterpretedMap& map) {
  std::optional<Isometry3d> levelled;
  for (const Vector3d& up : up_hints(scans))
    if (!levelled) levelled = level_by_floor(surface, up);
  if (!levelled) {
    map.notes.push_back("the input is not levelled and no floor was found to level it by: z was taken as up");
    return;
  }
  transform(surface, *levelled);
  map.semantics.map_from_input = *levelled;
  map.notes.push_back("the input was levelled by its floor; map_from_input holds the motion");
}

void find_levels(const Surface& surface, RecognisedRoom& room, InterpretedMap& map) {
  if (const auto height = peak_height(surface, -kFloorReach, kFloorReach, 1))
    room.floor = level_plane(surface, *height, 1, room.yaw);
  if (!room.floor) map.notes.push_back("no floor was seen: heights are above z = 0");
  if (const auto height = peak_height(surface, kCeilingLow, 5, -1)) {
    room.ceiling = level_plane(surface, *height, -1, room.yaw);
    if (room.ceiling && room.ceiling->area < 1) room.ceiling.reset();
  }
}

}  // namespace

void InterpretationOptions::declare(OptionTable& table) {
  table.number("support_min_area_m2", support_min_area_m2, "m2",
               "Horizontal surfaces of which less was seen are left out.", 0.005, 10);
  table.number("support_min_side_m", support_min_side_m, "m", "Narrower horizontal surfaces are left out.",
               0.02, 2);
  table.number("support_max_height_m", support_max_height_m, "m", "Higher horizontal surfaces are left out.",
               0.3, 5);
  table.number("wall_min_area_m2", wall_min_area_m2, "m2",
               "Vertical planes of which less was seen are no walls.", 0.05, 50);
  table.number("wall_min_top_m", wall_min_top_m, "m", "Vertical planes that end lower are furniture (§7.4).",
               0.1, 5);
  table.number("plane_tolerance_m", plane_tolerance_m, "m", "How far a point may lie off its plane.", 0.002,
               0.2);
  table.number("slab_thickness_m", slab_thickness_m, "m",
               "Thickness of a support's box in the URDF; it is not measured.", 0.001, 0.5);
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
  if (!scans.levelled) level(scans, surface, map);
  if (surface.free_space) leave_out_bad_scans(scans, surface, map.notes);

  RecognisedRoom room;
  room.free_space = surface.free_space;
  room.yaw = room_yaw(surface);
  find_levels(surface, room, map);
  const double floor_height = room.floor ? room.floor->height : 0;
  progress.check(0.35, "walls");
  WallSearch vertical = find_walls(
      surface, floor_height, room.ceiling ? std::optional(room.ceiling->height) : std::nullopt, options);
  lap("levels and walls");
  PartialProgress supporting(progress, 0.45, 0.7);
  SupportSearch horizontal = find_supports(surface, floor_height, room.yaw, vertical, options, supporting);
  lap("supports");
  PartialProgress fronting(progress, 0.7, 1);
  FrontSearch furniture = find_fronts(surface, floor_height, vertical, options, fronting);
  lap("fronts");
  room.walls = std::move(vertical.walls);
  room.supports = std::move(horizontal.supports);
  if (room.walls.empty()) map.notes.push_back("no walls were recognised");
  map.notes.insert(map.notes.end(), vertical.notes.begin(), vertical.notes.end());
  map.notes.insert(map.notes.end(), horizontal.notes.begin(), horizontal.notes.end());
  map.notes.insert(map.notes.end(), furniture.notes.begin(), furniture.notes.end());
  add_links(room, options, map);
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
    const std::string plural = count == 1 ? "" : class_name == "shelf" ? "ves" : "s";
    const std::string stem = plural == "ves" ? "shel" : class_name;
    text += fmt::format("{}{} {}{}", text.empty() ? "" : ", ", count, stem, plural);
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
