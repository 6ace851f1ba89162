#include "mapping/exchange/comparison/compare_furniture.h"

#include <algorithm>
#include <cmath>

#include "mapping/base/math/math.h"
#include "mapping/base/math/polygon.h"

namespace loci::mapping {
namespace {

constexpr double kPlaneGate = 0.10;    // m
constexpr double kNormalGate = 0.7;    // cosine
constexpr double kRegionMargin = 0.1;  // m
constexpr double kListedReach = 0.3;   // m, beside a listed front: half a front's width

struct Pair {
  size_t map, truth;
  double score;  ///< the lowest is the best
};

/// Takes the best pairs, each element once. Returns for each element of the truth its partner in the map.
std::vector<std::optional<size_t>> assign(std::vector<Pair> pairs, size_t truths,
                                          std::vector<std::optional<size_t>> partners = {}) {
  partners.resize(truths);
  std::ranges::stable_sort(pairs, {}, &Pair::score);
  for (const Pair& pair : pairs) {
    const bool taken =
        partners[pair.truth] || std::ranges::find(partners, std::optional(pair.map)) != partners.end();
    if (!taken) partners[pair.truth] = pair.map;
  }
  return partners;
}

double angle_deg(const Vector3d& a, const Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b)) / kDegree;
}

/// Whether an element that the truth does not have is a mistake: not where the truth was not asked.
bool in_region(const Vector3d& point, const MapStructure& truth, const ComparisonOptions& options) {
  const auto listed = [&](const KnownFront& known) {
    const Vector3d apart = point - known.front.centre;
    return std::abs(known.front.normal.dot(apart)) < kPlaneGate + kRegionMargin &&
           std::abs(known.front.right().dot(apart)) < known.front.width / 2 + kListedReach;
  };
  if (truth.only_listed_faces && std::ranges::none_of(truth.fronts, listed)) return false;
  const auto region = truth.regions.find(options.region);
  return region == truth.regions.end() || region->second.exteriorDistance(point) <= kRegionMargin;
}

/// The elements of a kind with their verdicts; `fill` writes the errors of a pair.
template <class Known, class Place, class Fill>
void judge(const std::string& kind, const std::vector<Known>& map, const MapStructure& truth,
           const std::vector<Known>& truths, const std::vector<std::optional<size_t>>& partners,
           const ComparisonOptions& options, const Place& place, const Fill& fill, Comparison& result) {
  std::vector<bool> used(map.size(), false);
  for (size_t j = 0; j < truths.size(); ++j) {
    const bool main = truths[j].main && asked_for(truths[j].region, options);
    ComparedElement element;
    element.kind = kind;
    element.truth_name = truths[j].name;
    if (partners[j]) {
      used[*partners[j]] = true;
      element.map_name = map[*partners[j]].name;
      element.verdict = main ? "matched" : "minor";
      fill(map[*partners[j]], truths[j], element);
    } else if (main) {
      element.verdict = "missed";
    } else {
      continue;
    }
    result.elements.push_back(std::move(element));
  }
  for (size_t i = 0; i < map.size(); ++i) {
    if (used[i]) continue;
    ComparedElement element;
    element.kind = kind;
    element.map_name = map[i].name;
    element.verdict = in_region(place(map[i]), truth, options) ? "extra" : "minor";
    result.elements.push_back(std::move(element));
  }
}

std::vector<std::optional<size_t>> handle_pairs(const MapStructure& map, const MapStructure& truth,
                                                const ComparisonOptions& options) {
  std::vector<Pair> pairs;
  for (size_t i = 0; i < map.fixtures.size(); ++i)
    for (size_t j = 0; j < truth.fixtures.size(); ++j) {
      const double distance = (map.fixtures[i].fixture.centre - truth.fixtures[j].fixture.centre).norm();
      if (distance <= options.handle_tolerance_m + truth.fixtures[j].tolerance)
        pairs.push_back({i, j, distance});
    }
  return assign(std::move(pairs), truth.fixtures.size());
}

std::optional<size_t> index_of(const std::string& name, const std::vector<KnownFront>& fronts) {
  const auto found = std::ranges::find(fronts, name, &KnownFront::name);
  if (found == fronts.end()) return std::nullopt;
  return static_cast<size_t>(found - fronts.begin());
}

std::vector<Pair> overlapping(const std::vector<KnownFront>& map, const std::vector<KnownFront>& truth,
                              const ComparisonOptions& options) {
  std::vector<Pair> pairs;
  for (size_t i = 0; i < map.size(); ++i)
    for (size_t j = 0; j < truth.size(); ++j) {
      const double overlap = overlap_of(map[i].front, truth[j].front);
      if (overlap >= options.min_outline_overlap) pairs.push_back({i, j, -overlap});
    }
  return pairs;
}

/// A front is what its handle opens; fronts without are matched by overlap.
std::vector<std::optional<size_t>> front_pairs(const MapStructure& map, const MapStructure& truth,
                                               const std::vector<std::optional<size_t>>& handles,
                                               const ComparisonOptions& options) {
  std::vector<Pair> by_handle;
  for (size_t j = 0; j < handles.size(); ++j) {
    if (!handles[j]) continue;
    const auto i = index_of(map.fixtures[*handles[j]].front, map.fronts);
    const auto of_truth = index_of(truth.fixtures[j].front, truth.fronts);
    if (!i || !of_truth) continue;
    const double overlap = overlap_of(map.fronts[*i].front, truth.fronts[*of_truth].front);
    if (overlap > 0) by_handle.push_back({*i, *of_truth, -overlap});
  }
  return assign(overlapping(map.fronts, truth.fronts, options), truth.fronts.size(),
                assign(std::move(by_handle), truth.fronts.size()));
}

/// The way a joint opens, whatever the sign of its axis.
Vector3d opening_axis(const JointEstimate& joint) {
  return -joint.lower > joint.upper ? Vector3d(-joint.axis) : joint.axis;
}

double distance_to_line(const Vector3d& point, const JointEstimate& line) {
  return (point - line.origin).cross(line.axis.normalized()).norm();
}

void fill_handle(const KnownFixture& map, const KnownFixture& truth, ComparedElement& element) {
  element.centre_error = (map.fixture.centre - truth.fixture.centre).norm();
  const double angle = angle_deg(map.fixture.axis, truth.fixture.axis);
  element.angle_error_deg = std::min(angle, 180 - angle);
}

void fill_front(const KnownFront& map, const KnownFront& truth, ComparedElement& element) {
  element.overlap = overlap_of(map.front, truth.front);
  element.angle_error_deg = angle_deg(map.front.normal, truth.front.normal);
  element.offset_error = truth.front.normal.dot(map.front.centre - truth.front.centre);
  if (truth.front.joint && truth.front.joint->type != ArticulationType::rigid)
    element.joint = compare_joints(map.front.joint, *truth.front.joint, truth.front.centre);
}

void fill_opening(const KnownFront& map, const KnownFront& truth, ComparedElement& element) {
  const Front &of_map = map.front, &of_truth = truth.front;
  element.overlap = overlap_of(of_map, of_truth);
  const Vector3d apart = of_map.centre - of_truth.centre;
  const double along = of_truth.right().dot(apart), wider = (of_map.width - of_truth.width) / 2;
  const double above = of_truth.up.dot(apart), higher = (of_map.height - of_truth.height) / 2;
  element.edge_errors = {along - wider, along + wider, above - higher, above + higher};
}

}  // namespace

bool asked_for(const std::string& region, const ComparisonOptions& options) {
  return options.region.empty() || region.empty() || region == options.region;
}

double overlap_of(const Front& a, const Front& b) {
  if (a.normal.dot(b.normal) < kNormalGate) return 0;
  if (std::abs(b.normal.dot(a.centre - b.centre)) > kPlaneGate) return 0;
  const auto corners = [&](const Front& front) {
    Polygon polygon;
    for (const auto& [x, y] : {std::pair{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}}) {
      const Vector3d corner =
          front.centre + x * front.width * front.right() + y * front.height * front.up - b.centre;
      polygon.emplace_back(b.right().dot(corner), b.up.dot(corner));
    }
    return polygon;
  };
  const Polygon of_a = corners(a), of_b = corners(b);
  const double shared = shared_area(of_a, of_b);
  return shared / (area_of(of_a) + area_of(of_b) - shared);
}

ComparedJoint compare_joints(const std::optional<JointEstimate>& map, const JointEstimate& truth,
                             const Vector3d& front_centre) {
  ComparedJoint joint;
  joint.truth_type = to_text(truth.type);
  if (!map) return joint;
  joint.map_type = to_text(map->type);
  joint.evidence = map->evidence;
  if (!joint.right()) return joint;
  const double angle = angle_deg(opening_axis(*map), opening_axis(truth));
  joint.axis_error_deg = std::min(angle, 180 - angle);
  joint.other_way = angle > 90;
  if (truth.type != ArticulationType::revolute) return joint;
  const Vector3d axis = truth.axis.normalized();
  const Vector3d hinge = truth.origin + axis.dot(front_centre - truth.origin) * axis;
  joint.hinge_error = distance_to_line(hinge, *map);
  return joint;
}

namespace {

bool is_on(const WallPatch& wall, const Vector3d& point, double tolerance) {
  const double along = Vector3d(-wall.normal.y(), wall.normal.x(), 0).dot(point);
  return std::abs(wall.normal.dot(point) - wall.offset) < tolerance && along > wall.along_min &&
         along < wall.along_max;
}

}  // namespace

void compare_openings(const MapStructure& map, const MapStructure& truth, const ComparisonOptions& options,
                      Comparison& result) {
  if (!truth.openings) return;
  std::vector<KnownFront> found = map.openings.value_or(std::vector<KnownFront>{});
  // Where walls of the truth end on both sides of a passage, the map may have one wall with an opening.
  std::erase_if(found, [&](const KnownFront& opening) {
    return std::ranges::none_of(truth.walls, [&](const WallPatch& wall) {
      return is_on(wall, opening.front.centre, options.wall_tolerance_m);
    });
  });
  judge(
      "opening", found, truth, *truth.openings,
      assign(overlapping(found, *truth.openings, options), truth.openings->size()), options,
      [](const KnownFront& known) { return known.front.centre; }, fill_opening, result);
}

void compare_furniture(const MapStructure& map, const MapStructure& truth, const ComparisonOptions& options,
                       Comparison& result) {
  const auto handles = handle_pairs(map, truth, options);
  const auto fronts = front_pairs(map, truth, handles, options);
  judge(
      "front", map.fronts, truth, truth.fronts, fronts, options,
      [](const KnownFront& known) { return known.front.centre; }, fill_front, result);
  judge(
      "handle", map.fixtures, truth, truth.fixtures, handles, options,
      [](const KnownFixture& known) { return known.fixture.centre; }, fill_handle, result);
}

}  // namespace loci::mapping
