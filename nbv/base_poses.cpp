#include "nbv/base_poses.h"

#include <algorithm>
#include <cmath>

#include "mapping/base/math/math.h"
#include "nbv/ray_casting.h"

namespace loci::nbv {
namespace {

/// By how much the limits of views are relaxed for fronts that cannot be seen within them.
constexpr double kRelaxedNear = 0.6, kRelaxedFar = 1.5, kRelaxedBearingDeg = 10;
constexpr double kShareSeen = 0.6;                         ///< of a front, at least half of that when relaxed
constexpr double kFixtureRoom = 0.1, kOpeningRoom = 0.05;  ///< m before what opens, and besides
constexpr double kInView = 0.3;  ///< cosine against the robot's heading: well within its sector
constexpr int kYaws = 16;
constexpr double kNearlyBest = 0.7;  ///< of the best view of a front: worse ones are for other fronts

double off_heading(const Vector2d& towards, double yaw) {
  return towards.normalized().dot(Vector2d(std::cos(yaw), std::sin(yaw)));
}

/// Whether a robot at a position leaves room for the front to open by `distance`.
bool leaves_room(const mapping::Front& front, const Vector2d& place, double distance, double robot_radius) {
  const Vector2d from_front = place - front.centre.head<2>();
  const double out = from_front.dot(front.normal.head<2>()),
               along = std::abs(from_front.dot(front.right().head<2>()));
  const double beyond_out = std::max({0.0, -out, out - distance - kFixtureRoom}),
               beyond_side = std::max(0.0, along - front.width / 2);
  return std::hypot(beyond_out, beyond_side) >= robot_radius + kOpeningRoom;
}

/// The part of a front, in nine pieces, that is in sight.
double share_seen(const mapping::Front& front, const Vector3d& from, const LineOfSight& sight) {
  int seen = 0;
  for (const double u : {-0.35, 0.0, 0.35})
    for (const double v : {-0.35, 0.0, 0.35}) {
      const Vector3d point = front.centre + u * front.width * front.right() + v * front.height * front.up;
      seen += sight.sees(from, point, front.normal) ? 1 : 0;
    }
  return seen / 9.0;
}

}  // namespace

void BasePoseOptions::declare(OptionTable& table) {
  table.number("min_standoff_m", min_distance_m, "m",
               "Nearest that the robot stands to a front that it pulls.", 0.3, 3);
  table.number("max_standoff_m", max_distance_m, "m",
               "Farthest that the robot stands from a front that it pulls.", 0.3, 5);
  table.number("max_pull_bearing_deg", max_bearing_deg, "deg", "Most oblique view of a front that is pulled.",
               0, 80);
}

BasePosePlanner::BasePosePlanner(const mapping::OccupancyMap& map, const mapping::PlanarPose& robot,
                                 const mapping::LaserModel& laser, const PlannerOptions& planner,
                                 const BasePoseOptions& options, double pull_distance_m)
    : voxels_(map.voxels()),
      laser_(laser),
      planner_(planner),
      options_(options),
      pull_distance_(pull_distance_m),
      floor_(drivable_floor(voxels_, robot, laser, planner)),
      reach_(reachability(floor_, robot, planner)) {}

/// Quality of the view of a front, 0 = too near, too far, too oblique, or hidden.
double BasePosePlanner::quality(const mapping::Front& front, const Vector2d& place,
                                const BasePoseOptions& limits) const {
  const Vector2d towards = place - front.centre.head<2>();
  const double distance = towards.norm();
  if (distance < limits.min_distance_m || distance > limits.max_distance_m) return 0;
  const double bearing = std::acos(std::clamp(towards.dot(front.normal.head<2>()) / distance, -1.0, 1.0));
  if (bearing > limits.max_bearing_deg * kDegree) return 0;
  if (!leaves_room(front, place, pull_distance_, planner_.robot_radius_m)) return 0;
  const LineOfSight sight(voxels_, laser_);
  const Vector3d from(place.x(), place.y(), laser_.height_m);
  const double share = share_seen(front, from, sight);
  const bool relaxed = limits.max_bearing_deg > options_.max_bearing_deg;
  if (share < (relaxed ? 0.5 : 1) * kShareSeen || !sight.sees(from, front.fixture->centre, front.normal))
    return 0;
  // Nearer is better; a little from the side is no worse: a drawer's motion is then seen across the ray.
  return share * std::cos(bearing / 2) / distance;
}

std::vector<Vector2d> BasePosePlanner::places() const {
  std::vector<Vector2d> places;
  for (int y = 0; y < floor_.height; ++y)
    for (int x = 0; x < floor_.width; ++x) {
      const Vector2d place = floor_.center(x, y);
      if (reach_.stands(floor_, floor_.index(x, y)) && !avoided(place, planner_)) places.push_back(place);
    }
  return places;
}

std::vector<BasePosePlanner::Candidate> BasePosePlanner::candidates(const std::vector<mapping::Front>& fronts,
                                                                    const std::vector<bool>& served,
                                                                    const BasePoseOptions& limits) const {
  std::vector<Candidate> candidates;
  for (const Vector2d& place : places()) {
    Candidate candidate{place, {}};
    for (size_t i = 0; i < fronts.size(); ++i) {
      if (served[i] || !fronts[i].fixture) continue;
      if (const double q = quality(fronts[i], place, limits); q > 0) candidate.fronts.emplace_back(i, q);
    }
    if (!candidate.fronts.empty()) candidates.push_back(std::move(candidate));
  }
  std::vector<double> best(fronts.size(), 0);
  for (const Candidate& candidate : candidates)
    for (const auto& [front, quality] : candidate.fronts) best[front] = std::max(best[front], quality);
  for (Candidate& candidate : candidates)
    std::erase_if(candidate.fronts,
                  [&](const auto& seen) { return seen.second < kNearlyBest * best[seen.first]; });
  return candidates;
}

std::vector<BasePose> BasePosePlanner::plan(const std::vector<mapping::Front>& fronts) const {
  std::vector<bool> served(fronts.size(), false);
  std::vector<BasePose> poses;
  // In narrow aisles and blocked corners the limits are relaxed.
  BasePoseOptions relaxed = options_;
  relaxed.min_distance_m *= kRelaxedNear;
  relaxed.max_distance_m *= kRelaxedFar;
  relaxed.max_bearing_deg += kRelaxedBearingDeg;
  const auto value = [&](const Candidate& candidate, size_t front, double quality, double yaw) {
    const double ahead = off_heading(fronts[front].centre.head<2>() - candidate.place, yaw);
    return served[front] || ahead < kInView ? 0 : quality * ahead;
  };
  for (const BasePoseOptions& limits : {options_, relaxed}) {
    const std::vector<Candidate> all = candidates(fronts, served, limits);
    while (true) {  // Greedy set cover; the sum of qualities decides.
      const Candidate* best = nullptr;
      double most = 0, best_yaw = 0;
      for (const Candidate& candidate : all)
        for (int i = 0; i < kYaws; ++i) {
          const double yaw = std::remainder(2 * kPi * i / kYaws, 2 * kPi);
          double sum = 0;
          for (const auto& [front, quality] : candidate.fronts) sum += value(candidate, front, quality, yaw);
          if (sum <= most + 1e-9) continue;
          most = sum;
          best = &candidate;
          best_yaw = yaw;
        }
      if (best == nullptr) break;
      BasePose pose{{best->place.x(), best->place.y(), best_yaw}, {}};
      for (const auto& [front, quality] : best->fronts)
        if (value(*best, front, quality, best_yaw) > 0) pose.fronts.push_back(front);
      for (const size_t front : pose.fronts) served[front] = true;
      poses.push_back(std::move(pose));
    }
  }
  return poses;
}

}  // namespace loci::nbv
