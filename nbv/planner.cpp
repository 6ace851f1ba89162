#include "nbv/planner.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "mapping/base/math/math.h"
#include "mapping/base/parallel.h"
#include "mapping/base/stopwatch.h"
#include "mapping/base/text/json.h"

namespace loci::nbv {
namespace {

constexpr double kAreaPerSample = 0.1;  ///< m²: poses nearer to each other see nearly the same
constexpr int kMinSamples = 8;
constexpr int kSamplesToStop = 4;    ///< factor on the number of positions that are cast before it stops
constexpr double kCoarseSteps = 3;   ///< the coarse panorama has a ninth of the rays
constexpr size_t kPlacesAtOnce = 2;  ///< cast with all rays per iteration
/// Times the score of the height at which the scanner is carried: moving it takes time, and scans of one
/// height overlap more.
constexpr double kRaiseGain = 1.1;

/// Voxels of a kind over each cell of the floor.
std::vector<int> projected(const mapping::Voxels& voxels, const ViewVoxels& view,
                           const mapping::FloorGrid& floor, ViewVoxel kind) {
  std::vector<int> counts(floor.cells(), 0);
  for (int z = 0; z < voxels.size.z(); ++z)
    for (int y = 0; y < voxels.size.y(); ++y)
      for (int x = 0; x < voxels.size.x(); ++x) {
        if (view.states[voxels.index({x, y, z})] != kind) continue;
        const Eigen::Vector2i cell = floor.cell_of(voxels.center({x, y, z}).head<2>());
        ++counts[floor.index(cell.x(), cell.y())];
      }
  return counts;
}

/// C = min(C_F, C_O), less for long paths, zero where the robot cannot stand.
CostmapStack combined(const ViewPlan& plan, const PlannerOptions& options) {
  CostmapStack costs = plan.frontier_costs;
  for (size_t layer = 0; layer < costs.layers.size(); ++layer)
    for (size_t cell = 0; cell < plan.floor.cells(); ++cell) {
      float& value = costs.layers[layer][cell];
      value =
          plan.reach.stands(plan.floor, cell) ? std::min(value, plan.occupied_costs.layers[layer][cell]) : 0;
      if (value > 0 && options.travel_cost_per_m > 0)
        value *= static_cast<float>(std::exp(-options.travel_cost_per_m * plan.reach.distance[cell]));
    }
  return costs;
}

/// Draws places in proportion to C, summed over orientations: systematic sampling, which spreads them over
/// the map. A place that is drawn again is kept once.
std::vector<size_t> draw_places(const CostmapStack& costs, size_t cells, int samples, Random random) {
  std::vector<double> sums(cells, 0);
  double total = 0;
  for (size_t cell = 0; cell < cells; ++cell) {
    for (const auto& layer : costs.layers) total += static_cast<double>(layer[cell]);
    sums[cell] = total;
  }
  std::vector<size_t> places;
  if (total <= 0) return places;
  const double step = total / samples;
  double mark = step * random.uniform();
  for (size_t cell = 0; cell < cells && mark < total; ++cell) {
    if (sums[cell] <= mark) continue;
    places.push_back(cell);
    mark += step * std::ceil((sums[cell] - mark) / step);
  }
  return places;
}

/// Binary entropy (eq. 7.2, logarithm to base 2).
double entropy(double p) {
  return p <= 0 || p >= 1 ? 0 : -p * std::log2(p) - (1 - p) * std::log2(1 - p);
}

double score_of(const ViewSample& sample, double gain_weight) {
  const ViewCounts& counts = sample.counts;
  const double paper = sample.cost_value * entropy(counts.overlap());
  if (gain_weight <= 0.5)
    return std::pow(counts.occupied, 1 - 2 * gain_weight) * std::pow(paper, 2 * gain_weight);
  return std::pow(paper, 2 - 2 * gain_weight) * std::pow(counts.frontier, 2 * gain_weight - 1);
}

bool eligible(const ViewSample& sample, const PlannerOptions& options) {
  return sample.counts.frontier >= options.min_gain && sample.counts.overlap() >= options.min_view_overlap &&
         !avoided({sample.pose.x, sample.pose.y}, options);
}

/// A position that is validated: one sample per orientation of the costmaps from one panorama.
struct ViewPlace {
  size_t cell = 0;
  bool fine = false;  ///< cast with all rays, not only coarsely
  std::vector<ViewSample> samples;
};

/// Casts the rays of some positions.
void cast_panoramas(const ViewPlan& plan, const ViewCaster& caster, const PlannerOptions& options,
                    const std::vector<ViewPlace*>& places) {
  const auto width = static_cast<size_t>(plan.floor.width);
  parallel_for(places.size(), options.threads, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      ViewPlace& place = *places[i];
      const Vector2d at =
          plan.floor.center(static_cast<int>(place.cell % width), static_cast<int>(place.cell / width));
      const std::vector<ViewCounts> panorama = caster.panorama(at);
      place.samples.resize(plan.costs.layers.size());
      for (size_t layer = 0; layer < place.samples.size(); ++layer) {
        ViewSample& sample = place.samples[layer];
        const double yaw = plan.costs.yaw(layer);
        sample.pose = {at.x(), at.y(), std::remainder(yaw, 2 * kPi)};
        sample.cost_value = static_cast<double>(plan.costs.layers[layer][place.cell]);
        sample.counts = caster.part(panorama, yaw);
        sample.score = score_of(sample, options.gain_weight);
      }
    }
  });
}

/// The best score of a place among the poses that may be chosen; negative = none.
double best_score(const ViewPlace& place, const PlannerOptions& options) {
  double best = -1;
  for (const ViewSample& sample : place.samples)
    if (eligible(sample, options)) best = std::max(best, sample.score);
  return best;
}

/// Casts all positions coarsely, then the best ones with all rays until the best one is a fine one.
std::vector<ViewSample> validate(const ViewPlan& plan, const std::vector<size_t>& cells,
                                 const mapping::LaserModel& laser, const PlannerOptions& options) {
  const auto caster = [&](double step_deg) {
    return ViewCaster(plan.voxels, plan.frontier, laser, options.max_distance_m, step_deg);
  };
  const ViewCaster coarse = caster(kCoarseSteps * options.ray_step_deg), fine = caster(options.ray_step_deg);
  std::vector<ViewPlace> places(cells.size());
  std::vector<ViewPlace*> order;
  for (size_t i = 0; i < cells.size(); ++i) {
    places[i].cell = cells[i];
    order.push_back(&places[i]);
  }
  cast_panoramas(plan, coarse, options, order);
  while (true) {
    std::stable_sort(order.begin(), order.end(), [&](const ViewPlace* a, const ViewPlace* b) {
      return best_score(*a, options) > best_score(*b, options);
    });
    if (order.empty() || order.front()->fine) break;
    std::vector<ViewPlace*> next;
    for (ViewPlace* place : order)
      if (next.size() < kPlacesAtOnce && !place->fine && best_score(*place, options) > 0)
        next.push_back(place);
    if (next.empty()) break;
    cast_panoramas(plan, fine, options, next);
    for (ViewPlace* place : next) place->fine = true;
  }
  std::vector<ViewSample> samples;
  for (const ViewPlace& place : places)
    samples.insert(samples.end(), place.samples.begin(), place.samples.end());
  return samples;
}

Json sample_json(const ViewSample& sample) {
  return {{"pose", {sample.pose.x, sample.pose.y, sample.pose.yaw / kDegree}},
          {"cost_value", sample.cost_value},
          {"occupied_m2", sample.counts.occupied},
          {"frontier_m2", sample.counts.frontier},
          {"overlap", sample.counts.overlap()},
          {"score", sample.score}};
}

/// Chooses among the validated samples, or says why to stop and returns null.
const ViewSample* decide(ViewPlan& plan, const PlannerOptions& options) {
  NextView& view = plan.view;
  double gain_best = 0;
  const ViewSample* best = nullptr;
  for (const ViewSample& sample : plan.samples) {
    if (!avoided({sample.pose.x, sample.pose.y}, options))
      gain_best = std::max(gain_best, sample.counts.frontier);
    if (eligible(sample, options) && (best == nullptr || sample.score > best->score)) best = &sample;
  }
  view.details["gain_best_m2"] = gain_best;
  if (best == nullptr || best->score <= 0) {
    view.reason = fmt::format("no reachable view gains {} m² behind the frontier (the best {:.2f})",
                              options.min_gain, gain_best);
    return nullptr;
  }
  view.pose = best->pose;
  view.expected_overlap = best->counts.overlap();
  view.expected_gain = best->counts.frontier;
  view.reason = fmt::format("may show {:.2f} m² behind the frontier, {:.0f} % overlap{}", view.expected_gain,
                            100 * view.expected_overlap,
                            view.expected_overlap < options.overlap_wanted ? ", less than wanted" : "");
  return best;
}

/// Raises or lowers the scanner at the chosen pose where that scores higher.
void choose_height(ViewPlan& plan, const ViewSample& chosen, const mapping::PlanarPose& robot,
                   const mapping::LaserModel& laser, const PlannerOptions& options) {
  double most = kRaiseGain * chosen.score;
  for (const double height : options.heights) {
    if (height == laser.height_m) continue;
    mapping::LaserModel moved = laser;
    moved.height_m = height;
    ViewSample sample = chosen;
    sample.counts =
        ViewCaster(plan.voxels, plan.frontier, moved, options.max_distance_m, options.ray_step_deg)
            .view(chosen.pose);
    sample.score = score_of(sample, options.gain_weight);
    if (sample.score <= most || !eligible(sample, options)) continue;
    std::vector<mapping::PlanarPose> path = plan.view.path;
    if (height > laser.height_m) {  // Higher than what the floor was judged for.
      const mapping::FloorGrid floor = drivable_floor(plan.voxels, robot, moved, options);
      const Reachability reach = reachability(floor, robot, options);
      const Eigen::Vector2i cell = floor.cell_of({chosen.pose.x, chosen.pose.y});
      if (!reach.stands(floor, floor.index(cell.x(), cell.y()))) continue;
      path = path_to(floor, reach, chosen.pose);
    }
    most = sample.score;
    plan.view.path = path;
    plan.view.height_m = height;
    plan.view.expected_overlap = sample.counts.overlap();
    plan.view.expected_gain = sample.counts.frontier;
    plan.view.reason =
        fmt::format("may show {:.2f} m² behind the frontier from {} m height, {:.0f} % overlap",
                    plan.view.expected_gain, height, 100 * plan.view.expected_overlap);
  }
}

std::vector<VisibilityKernel> kernels_of(const PlannerOptions& options, double cell) {
  std::vector<VisibilityKernel> kernels;
  for (int i = 0; i < options.orientations; ++i)
    kernels.emplace_back(options.opening_deg * kDegree, options.min_distance_m, options.max_distance_m,
                         2 * kPi * i / options.orientations, cell);
  return kernels;
}

/// C_F and C_O.
void add_costmaps(ViewPlan& plan, const PlannerOptions& options) {
  const std::vector<VisibilityKernel> kernels = kernels_of(options, plan.floor.cell);
  plan.frontier_costs =
      vote(plan.floor, projected(plan.voxels, plan.frontier, plan.floor, ViewVoxel::frontier), kernels,
           options.threads);
  plan.occupied_costs =
      vote(plan.floor, projected(plan.voxels, plan.frontier, plan.floor, ViewVoxel::occupied), kernels,
           options.threads);
}

/// min(C_F, C_O) at a pose, in the layer nearest to its orientation.
double cost_at(const ViewPlan& plan, const mapping::PlanarPose& pose) {
  const Eigen::Vector2i cell = plan.floor.cell_of({pose.x, pose.y});
  if (!plan.floor.contains(cell.x(), cell.y())) return 0;
  const auto layers = static_cast<int>(plan.frontier_costs.layers.size());
  const int nearest = static_cast<int>(std::lround(pose.yaw / (2 * kPi) * layers));
  const auto layer = static_cast<size_t>((nearest % layers + layers) % layers);
  const size_t at = plan.floor.index(cell.x(), cell.y());
  return static_cast<double>(
      std::min(plan.frontier_costs.layers[layer][at], plan.occupied_costs.layers[layer][at]));
}

}  // namespace

void PlannerOptions::declare(OptionTable& table) {
  table.number("cell_m", cell_m, "m", "Cell of the costmaps.", 0.02, 1);
  table.integer("orientations", orientations, "", "Orientations of the costmaps.", 1, 72);
  table.number("min_distance_m", min_distance_m, "m",
               "Of the visibility kernel: nearest floor that the scanner sees.", 0, 10);
  table.number("max_distance_m", max_distance_m, "m", "Of the visibility kernel: farthest useful distance.",
               0.5, 30);
  table.number("opening_deg", opening_deg, "deg", "Opening angle of the visibility kernel.", 10, 360);
  table.number("robot_radius_m", robot_radius_m, "m", "Radius by which obstacles are dilated.", 0.05, 2);
  table.number("overlap_wanted", overlap_wanted, "", "Views with less overlap with known space are reported.",
               0, 1);
  table.number("min_view_overlap", min_view_overlap, "",
               "Views with less overlap with known space are not chosen: their scan could not be registered.",
               0, 1);
  table.number("gain_weight", gain_weight, "",
               "0 looks for overlap only, 0.5 for as much gain as overlap, 1 for gain only.", 0, 1);
  table.integer("samples", samples, "",
                "Places that are validated by ray casting, at most; there is one per 0.1 m² of reachable "
                "floor. Before it "
                "stops, four times as many.",
                1, 10000);
  table.number("ray_step_deg", ray_step_deg, "deg", "Between rays of the validation.", 0.25, 10);
  table.number("travel_cost_per_m", travel_cost_per_m, "1/m",
               "Weight of a position: e^(-cost · path length).", 0, 10);
  table.number("min_gain", min_gain, "m²", "Stops when no view gains more (expected_gain).", 0, 100);
  table.text("within", within,
             "Rectangle on the floor to explore and to stay in, x0,y0,x1,y1 in m; empty: everywhere.");
}

bool avoided(const Vector2d& place, const PlannerOptions& options) {
  return std::any_of(options.avoid.begin(), options.avoid.end(), [&](const Vector2d& failed) {
    return (place - failed).norm() < options.robot_radius_m;
  });
}

double body_height(const mapping::LaserModel& laser) {
  return laser.height_m + 0.1;
}

mapping::FloorGrid drivable_floor(const mapping::Voxels& voxels, const mapping::PlanarPose& robot,
                                  const mapping::LaserModel& laser, const PlannerOptions& options) {
  mapping::FloorGrid floor = floor_grid(voxels, options.cell_m, body_height(laser));
  const mapping::FloorRegion within(options.within);
  for (int y = 0; y < floor.height && !within.everywhere(); ++y)
    for (int x = 0; x < floor.width; ++x)
      if (!within.contains(floor.center(x, y)))
        floor.seen[floor.index(x, y)] = floor.open[floor.index(x, y)] = 0;
  const Eigen::Vector2i here = floor.cell_of({robot.x, robot.y});
  if (floor.contains(here.x(), here.y())) {
    const size_t at = floor.index(here.x(), here.y());
    floor.seen[at] = floor.clear[at] = 1;
  }
  return floor;
}

Reachability reachability(const mapping::FloorGrid& floor, const mapping::PlanarPose& robot,
                          const PlannerOptions& options) {
  return shortest_paths(floor, robot, options.robot_radius_m, options.min_distance_m + 2 * floor.cell);
}

ViewPlan plan_view(const mapping::OccupancyMap& map, const mapping::PlanarPose& robot,
                   const mapping::LaserModel& laser, const PlannerOptions& options, const Random& random) {
  ViewPlan plan;
  Stopwatch watch;
  Json times;
  plan.voxels = map.voxels();
  plan.frontier = find_frontier(plan.voxels, options.threads, mapping::FloorRegion(options.within));
  plan.view.frontier_voxels = plan.frontier.frontier;
  times["frontier"] = watch.lap();
  plan.floor = drivable_floor(plan.voxels, robot, laser, options);
  plan.reach = reachability(plan.floor, robot, options);
  size_t standing = 0;
  for (size_t cell = 0; cell < plan.floor.cells(); ++cell)
    standing += plan.reach.stands(plan.floor, cell) ? 1 : 0;
  times["paths"] = watch.lap();
  add_costmaps(plan, options);
  plan.costs = combined(plan, options);
  times["costmaps"] = watch.lap();
  const double standing_m2 = static_cast<double>(standing) * plan.floor.cell * plan.floor.cell;
  const int samples = std::clamp(static_cast<int>(standing_m2 / kAreaPerSample),
                                 std::min(kMinSamples, options.samples), options.samples);
  std::vector<size_t> places = draw_places(plan.costs, plan.floor.cells(), samples, random);
  plan.samples = validate(plan, places, laser, options);
  const auto gains = [&](const ViewSample& sample) { return eligible(sample, options) && sample.score > 0; };
  if (std::none_of(plan.samples.begin(), plan.samples.end(), gains)) {
    places = draw_places(plan.costs, plan.floor.cells(), kSamplesToStop * samples, random.fork(1));
    plan.samples = validate(plan, places, laser, options);
  }
  times["validation"] = watch.lap();

  plan.view.details = {
      {"reachable_m2", standing_m2}, {"frontier_voxels", plan.frontier.frontier}, {"places", places.size()}};
  if (plan.voxels.states.empty())
    plan.view.reason = "nothing is known yet: scan where the robot stands";
  else if (standing == 0)
    plan.view.reason = "no pose can be reached: there is no free floor that was seen around the robot";
  else if (plan.frontier.frontier == 0)
    plan.view.reason = "free space borders on nothing unknown";
  else if (const ViewSample* best = decide(plan, options); best != nullptr) {
    plan.view.path = path_to(plan.floor, plan.reach, best->pose);
    choose_height(plan, *best, robot, laser, options);
  }
  times["height"] = watch.lap();
  plan.view.details["times_s"] = times;
  for (const ViewSample& sample : plan.samples) plan.view.details["samples"].push_back(sample_json(sample));
  return plan;
}

PoolChoice choose_view(const mapping::OccupancyMap& map, const std::vector<mapping::PlanarPose>& poses,
                       const mapping::LaserModel& laser, const PlannerOptions& options) {
  ViewPlan plan;
  plan.voxels = map.voxels();
  plan.frontier = find_frontier(plan.voxels, options.threads, mapping::FloorRegion(options.within));
  plan.view.frontier_voxels = plan.frontier.frontier;
  plan.floor = floor_grid(plan.voxels, options.cell_m, body_height(laser));
  add_costmaps(plan, options);
  const ViewCaster caster(plan.voxels, plan.frontier, laser, options.max_distance_m, options.ray_step_deg);
  plan.samples.resize(poses.size());
  parallel_for(poses.size(), options.threads, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      ViewSample& sample = plan.samples[i];
      sample.pose = poses[i];
      sample.counts = caster.view(poses[i]);
      sample.cost_value = cost_at(plan, poses[i]);
      sample.score = score_of(sample, options.gain_weight);
    }
  });
  PoolChoice choice;
  if (plan.voxels.states.empty())
    plan.view.reason = "nothing is known yet: begin with any scan";
  else if (const ViewSample* best = decide(plan, options); best != nullptr)
    choice.index = static_cast<size_t>(best - plan.samples.data());
  for (const ViewSample& sample : plan.samples) plan.view.details["samples"].push_back(sample_json(sample));
  choice.view = std::move(plan.view);
  return choice;
}

NextView next_view(const mapping::OccupancyMap& map, const mapping::PlanarPose& robot,
                   const mapping::LaserModel& laser, const PlannerOptions& options, const Random& random) {
  return plan_view(map, robot, laser, options, random).view;
}

}  // namespace loci::nbv
