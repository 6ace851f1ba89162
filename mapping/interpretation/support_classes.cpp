#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "mapping/interpretation/support_checks.h"

namespace loci::mapping {
namespace {

constexpr double kNearWall = 0.25;    // m; nearer than this a support stands at the wall
constexpr double kOpenBelow = 0.05;   // fraction of the footprint seen from below; more is free space
constexpr double kNarrow = 0.33;      // m; a narrower board at a wall is a shelf
constexpr double kShelfLength = 0.5;  // m; shorter things against a wall above a counter stand on it
constexpr double kTableTop = 0.80;    // m; tables are lower, counters higher
constexpr double kCounterTop = 1.05;  // m
constexpr double kLowCounter = 0.65;  // m; lower things over cabinets are shelves
constexpr double kBarTop = 1.2;       // m
constexpr double kLegs = 0.4;         // fraction of the footprint seen from below that only legs leave free
constexpr double kTableLength = 0.6;  // m
constexpr double kSeatLow = 0.36;     // m
constexpr double kSeatHigh = 0.54;
constexpr double kSeatSide = 0.62;  // m; largest side of a seat
constexpr double kOnTop = 0.45;     // m; a surface this little above another one stands on it

double shorter_side(const Support& support) {
  return support.parts.front().size().minCoeff();
}

/// Fraction of a support's first rectangle that lies within another support.
double fraction_within(const Support& inner, const Support& outer) {
  const Extent& part = inner.parts.front();
  constexpr int kSteps = 12;
  int inside = 0;
  for (int i = 0; i < kSteps; ++i)
    for (int j = 0; j < kSteps; ++j) {
      const Vector2d local =
          part.min + Vector2d((i + 0.5) / kSteps, (j + 0.5) / kSteps).cwiseProduct(part.size());
      const Vector2d at = Eigen::Rotation2Dd(-outer.yaw) * (inner.map_from_axes() * local);
      inside += std::any_of(outer.parts.begin(), outer.parts.end(),
                            [&](const Extent& e) { return e.contains(at, 0.03); });
    }
  return static_cast<double>(inside) / (kSteps * kSteps);
}

std::string where(const Support& support) {
  const Vector2d centre = support.map_from_axes() * support.parts.front().centre();
  const Vector2d size = support.parts.front().size();
  return fmt::format("horizontal surface of {:.2f} x {:.2f} m at ({:.2f}, {:.2f}), {:.2f} m high", size.x(),
                     size.y(), centre.x(), centre.y(), support.height);
}

/// Whether a low surface begins at or below the edge of a larger solid one and stands out before it.
bool juts_out_below(const Support& support, const Support& other) {
  const double below = other.height - support.height;
  if (below < 0.05 || below > 0.8 || support.area() > 0.4 * other.area()) return false;
  if (other.seen_below > kOpenBelow && !other.behind_face) return false;
  constexpr double kAtEdge = 0.06;  // m
  const Eigen::Rotation2Dd other_from_map(-other.yaw);
  const Extent& part = support.parts.front();
  bool inside = false;
  bool outside = false;
  for (const double x : {part.min.x(), part.centre().x(), part.max.x()})
    for (const double y : {part.min.y(), part.centre().y(), part.max.y()}) {
      const Vector2d at = other_from_map * (support.map_from_axes() * Vector2d(x, y));
      const bool holds = std::any_of(other.parts.begin(), other.parts.end(),
                                     [&](const Extent& e) { return e.contains(at, kAtEdge); });
      (holds ? inside : outside) = true;
    }
  return inside && outside;
}

/// Why a surface is no piece of the room's furniture; empty when it is.
std::string why_left_out(const Support& support, const SupportSearch& search, double floor_height) {
  const double height = support.height - floor_height;
  for (const Support& other : search.supports) {
    const double above = support.height - other.height;
    if (&other == &support || other.area() < 1.5 * support.area()) continue;
    const bool shelf_like = support.wall_distance < 0.05 && above > 0.25 &&
                            support.parts.front().size().maxCoeff() > kShelfLength;
    if (above > 0.02 && above < kOnTop && !shelf_like && fraction_within(support, other) > 0.6)
      return "it stands on a larger surface";
    if (std::abs(above) <= 0.06 && fraction_within(support, other) > 0.4)
      return "it overlaps a larger surface of about its height";
    if (juts_out_below(support, other)) return "it juts out from below a larger one, as an open drawer does";
  }
  const double longer = support.parts.front().size().maxCoeff();
  const bool open_below = support.seen_below > kOpenBelow;
  const bool at_wall = support.wall_distance < kNearWall;
  if (height > kSeatLow && height < kSeatHigh && longer < kSeatSide && (open_below || !at_wall))
    return "it has the size and height of a seat";
  constexpr double kSmall = 0.12;  // m²
  if (support.area() < kSmall && !at_wall && open_below) return "it is small and stands free";
  return {};
}

/// Whether one can walk around a support: no wall near, and rays passed it on three sides at least (the
/// fourth may not have been looked at).
bool free_all_round(const Support& support) {
  constexpr double kWalk = 0.5;  // m
  return support.wall_distance > kWalk &&
         std::count(support.edges.begin(), support.edges.end(), EdgeKind::free) >= 3;
}

void choose_class(Support& support, double floor_height, bool free_space) {
  const double height = support.height - floor_height;
  const double depth = shorter_side(support);
  const bool at_wall = support.wall_distance < kNearWall;
  const bool open_below = free_space && support.seen_below > kOpenBelow;
  const std::string tall = fmt::format("{:.2f} m high", height);
  const std::string below =
      !free_space  ? "free space below unknown"
      : open_below ? fmt::format("free space seen under {:.0f} % of it", 100 * support.seen_below)
                   : "no free space seen below";
  const std::string basis = support.behind_face ? "; extent from its front and the wall" : "";
  const std::string beside = support.wall_distance > 1e6 ? "no wall beside it"
                             : at_wall ? fmt::format("{:.2f} m from a wall", support.wall_distance)
                                       : fmt::format("{:.2f} m away from the walls", support.wall_distance);
  const bool stands_on_legs = open_below && support.seen_below > kLegs && height >= kSeatLow &&
                              height <= kBarTop && support.parts.front().size().maxCoeff() > kTableLength;
  if (depth < kNarrow && at_wall)
    support.class_name = "shelf",
    support.reason = fmt::format("only {:.2f} m deep; {}; {}", depth, tall, beside);
  else if (stands_on_legs)
    support.class_name = "table", support.reason = fmt::format("{}; {}; {}", tall, below, beside + basis);
  else if (height >= kTableTop && height <= kCounterTop && free_all_round(support))
    support.class_name = "island", support.reason = fmt::format("{}; {}; {}", tall, below, beside + basis);
  else if (height >= kTableTop && height <= kCounterTop)
    support.class_name = "counter", support.reason = fmt::format("{}; {}; {}", tall, below, beside + basis);
  else if (height < kTableTop && height >= kLowCounter && free_space && at_wall && !open_below)
    support.class_name = "counter", support.reason = fmt::format("{}; {}; {}", tall, below, beside + basis);
  else if (height < kTableTop && depth >= kNarrow && (open_below || !at_wall))
    support.class_name = "table", support.reason = fmt::format("{}; {}; {}", tall, below, beside + basis);
  else
    support.class_name = "shelf", support.reason = fmt::format("{}; {}; {}", tall, below, beside + basis);
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
