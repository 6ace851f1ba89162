#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "mapping/interpretation/supports/parameters.h"
#include "mapping/interpretation/supports/refinement.h"

namespace loci::mapping {
namespace {

double shorter_side(const Support& support) {
  return support.parts.front().size().minCoeff();
}

/// Fraction of a support's first rectangle that lies within another support.
double fraction_within(const Support& inner, const Support& outer) {
  return covered_fraction(inner, outer, kClasses.overlap_steps, 0.03);
}

std::string where(const Support& support) {
  const Vector2d centre = support.map_from_axes() * support.parts.front().centre();
  const Vector2d size = support.parts.front().size();
  return fmt::format("horizontal surface of {:.2f} x {:.2f} m at ({:.2f}, {:.2f}), {:.2f} m high", size.x(),
                     size.y(), centre.x(), centre.y(), support.height);
}

/// Whether a surface protrudes from below the edge of a larger solid one.
bool juts_out_below(const Support& support, const Support& other) {
  const double below = other.height - support.height;
  if (below < 0.05 || below > 0.8 || support.area() > 0.4 * other.area()) return false;
  if (other.seen_below > kClasses.min_open_below && !other.behind_face) return false;
  const Extent& part = support.parts.front();
  bool inside = false;
  bool outside = false;
  for (const double x : {part.min.x(), part.centre().x(), part.max.x()})
    for (const double y : {part.min.y(), part.centre().y(), part.max.y()})
      (other.contains(support.map_from_axes() * Vector2d(x, y), kClasses.edge_reach_m) ? inside : outside) =
          true;
  return inside && outside;
}

/// Why a surface is not furniture of the room; empty when it is.
std::string why_left_out(const Support& support, const SupportSearch& search, double floor_height) {
  const double height = support.height - floor_height;
  for (const Support& other : search.supports) {
    const double above = support.height - other.height;
    if (&other == &support || other.area() < 1.5 * support.area()) continue;
    const bool shelf_like = support.wall_distance < 0.05 && above > 0.25 &&
                            support.parts.front().size().maxCoeff() > kClasses.min_shelf_m;
    if (above > 0.02 && above < kClasses.on_top_m && !shelf_like && fraction_within(support, other) > 0.6)
      return "it stands on a larger surface";
    if (std::abs(above) <= 0.06 && fraction_within(support, other) > 0.4)
      return "it overlaps a larger surface of about its height";
    if (juts_out_below(support, other)) return "it juts out from below a larger one, as an open drawer does";
  }
  const double longer = support.parts.front().size().maxCoeff();
  const bool open_below = support.seen_below > kClasses.min_open_below;
  const bool at_wall = support.wall_distance < kClasses.near_wall_m;
  if (height > kClasses.min_seat_m && height < kClasses.max_seat_m && longer < kClasses.max_seat_side_m &&
      (open_below || !at_wall))
    return "it has the size and height of a seat";
  if (support.area() < kClasses.small_m2 && !at_wall && open_below) return "it is small and stands free";
  return {};
}

/// Whether a person can walk round a support: no wall near, and rays passed it on at least three sides (the
/// fourth may not have been observed).
bool free_all_round(const Support& support) {
  return support.wall_distance > kClasses.walk_m &&
         std::count(support.edges.begin(), support.edges.end(), EdgeKind::free) >= 3;
}

void choose_class(Support& support, double floor_height, bool free_space) {
  const double height = support.height - floor_height;
  const double depth = shorter_side(support);
  const bool at_wall = support.wall_distance < kClasses.near_wall_m;
  const bool open_below = free_space && support.seen_below > kClasses.min_open_below;
  const std::string tall = fmt::format("{:.2f} m high", height);
  const std::string below =
      !free_space  ? "free space below unknown"
      : open_below ? fmt::format("free space seen under {:.0f} % of it", 100 * support.seen_below)
                   : "no free space seen below";
  const std::string basis = support.behind_face ? "; extent from its front and the wall" : "";
  const std::string beside = support.wall_distance > 1e6 ? "no wall beside it"
                             : at_wall ? fmt::format("{:.2f} m from a wall", support.wall_distance)
                                       : fmt::format("{:.2f} m away from the walls", support.wall_distance);
  const bool stands_on_legs = open_below && support.seen_below > kClasses.leg_openness &&
                              height >= kClasses.min_seat_m && height <= kClasses.max_bar_m &&
                              support.parts.front().size().maxCoeff() > kClasses.min_table_m;
  const bool counter_height = height >= kClasses.table_top_m && height <= kClasses.max_counter_m;
  const bool low_counter = height < kClasses.table_top_m && height >= kClasses.min_counter_m && free_space &&
                           at_wall && !open_below;
  const bool shallow = depth < kClasses.shelf_depth_m && at_wall;
  const auto class_name = [&] {
    if (shallow) return "shelf";
    if (stands_on_legs) return "table";
    if (counter_height && free_all_round(support)) return "island";
    if (counter_height || low_counter) return "counter";
    if (height < kClasses.table_top_m && depth >= kClasses.shelf_depth_m && (open_below || !at_wall))
      return "table";
    return "shelf";
  };
  support.class_name = class_name();
  support.reason = shallow ? fmt::format("only {:.2f} m deep; {}; {}", depth, tall, beside)
                           : fmt::format("{}; {}; {}{}", tall, below, beside, basis);
}

}  // namespace

void classify(SupportSearch& search, const Surface& surface, double floor_height) {
  std::vector<Support> kept;
  for (const Support& support : search.supports) {
    const std::string why = why_left_out(support, search, floor_height);
    if (!why.empty()) {
      search.notes.push_back(where(support) + " left out: " + why);
      continue;
    }
    kept.push_back(support);
    choose_class(kept.back(), floor_height, surface.free_space);
  }
  search.supports = std::move(kept);
}

}  // namespace loci::mapping
