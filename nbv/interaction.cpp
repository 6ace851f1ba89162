#include "nbv/interaction.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "mapping/base/files.h"
#include "mapping/base/stopwatch.h"
#include "mapping/interpretation/furniture_links.h"

namespace loci {
namespace {

namespace fs = std::filesystem;

constexpr double kRadians = M_PI / 180;
constexpr double kRobotHeight = 1.4;  // m; lower things are in its way
/// By how much the limits of views are relaxed for fronts that cannot be seen within them.
constexpr double kRelaxedNear = 0.6, kRelaxedFar = 1.5, kRelaxedBearingDeg = 10;
constexpr int kFailuresMax = 8;  ///< stops that may turn out to be blocked

/// A pose from which some fronts are seen well.
struct Candidate {
  PlanarPose pose;
  std::vector<size_t> fronts;
};

/// How well a front is seen from a place, in (0,1]; 0 = too near, too far, too oblique.
double view_quality(const Front& front, const Vector2d& place, const InteractionOptions& options) {
  const Vector2d towards = place - front.centre.head<2>();
  const double distance = towards.norm();
  if (distance < options.distance_min_m || distance > options.distance_max_m) return 0;
  const double bearing = std::acos(std::clamp(towards.dot(front.normal.head<2>()) / distance, -1.0, 1.0));
  if (bearing > options.bearing_max_deg * kRadians) return 0;
  // Nearer is better, and so is a little from the side: a drawer's motion is then seen across the ray.
  return std::cos(bearing / 2) / (1 + distance);
}

/// The places that the robot can drive to, with the fronts that it would see well there.
std::vector<Candidate> candidates_for(const std::vector<Front>& fronts, const std::vector<bool>& served,
                                      const OccupancyMap& map, const PlanarPose& robot,
                                      const PlannerOptions& planner, const InteractionOptions& options) {
  const FloorGrid floor = floor_grid(map.voxels(), planner.cell_m, kRobotHeight);
  const Reach reach = find_ways(floor, robot, planner.robot_radius_m, planner.distance_min_m);
  std::vector<Candidate> candidates;
  for (size_t cell = 0; cell < floor.cells(); ++cell) {
    if (!reach.stands(floor, cell)) continue;
    const auto width = static_cast<size_t>(floor.width);
    const Vector2d place = floor.center(static_cast<int>(cell % width), static_cast<int>(cell / width));
    if (std::any_of(planner.avoid.begin(), planner.avoid.end(),
                    [&](const Vector2d& p) { return (p - place).norm() < planner.robot_radius_m; }))
      continue;
    Candidate candidate;
    Vector2d middle = Vector2d::Zero();
    for (size_t i = 0; i < fronts.size(); ++i) {
      if (served[i] || !fronts[i].fixture || view_quality(fronts[i], place, options) == 0) continue;
      candidate.fronts.push_back(i);
      middle += (fronts[i].centre.head<2>() - place).normalized();
    }
    if (candidate.fronts.empty()) continue;
    candidate.pose = {place.x(), place.y(), std::atan2(middle.y(), middle.x())};
    candidates.push_back(std::move(candidate));
  }
  return candidates;
}

/// Whether a front is in the half plane that a scan from this pose covers.
bool in_view(const Front& front, const PlanarPose& pose) {
  const Vector2d towards = front.centre.head<2>() - Vector2d(pose.x, pose.y);
  return towards.dot(Vector2d(std::cos(pose.yaw), std::sin(pose.yaw))) > 0.3 * towards.norm();
}

}  // namespace

void InteractionOptions::declare(OptionTable& table) {
  table.number("pull_way_m", pull_way_m, "m", "How far the hand pulls at a handle.", 0.02, 1);
  table.number("pull_distance_min_m", distance_min_m, "m",
               "Nearest that the robot stands to a front that it pulls.", 0.3, 3);
  table.number("pull_distance_max_m", distance_max_m, "m",
               "Farthest that the robot stands from a front that it pulls.", 0.3, 5);
  table.number("pull_bearing_max_deg", bearing_max_deg, "deg", "Most oblique view of a front that is pulled.",
               0, 80);
  difference.declare(table);
}

namespace {

/// Greedy set cover of the fronts that are not served yet; the sum of qualities decides.
void add_stops(const std::vector<Front>& fronts, const std::vector<Candidate>& candidates,
               const InteractionOptions& options, std::vector<bool>& served,
               std::vector<InteractionStop>& stops) {
  while (true) {
    const Candidate* best = nullptr;
    double most = 0;
    for (const Candidate& candidate : candidates) {
      double sum = 0;
      for (const size_t i : candidate.fronts)
        if (!served[i] && in_view(fronts[i], candidate.pose))
          sum += view_quality(fronts[i], {candidate.pose.x, candidate.pose.y}, options);
      if (sum > most + 1e-9) {
        most = sum;
        best = &candidate;
      }
    }
    if (best == nullptr) return;
    InteractionStop stop{best->pose, {}};
    for (const size_t i : best->fronts) {
      if (served[i] || !in_view(fronts[i], best->pose)) continue;
      served[i] = true;
      stop.fronts.push_back(i);
    }
    stops.push_back(std::move(stop));
  }
}

}  // namespace

std::vector<InteractionStop> plan_stops(const std::vector<Front>& fronts, const OccupancyMap& map,
                                        const PlanarPose& robot, const PlannerOptions& planner,
                                        const InteractionOptions& options) {
  std::vector<bool> served(fronts.size(), false);
  std::vector<InteractionStop> stops;
  // Aisles are narrow, corners are blocked: what cannot be seen well is seen as well as it can be.
  InteractionOptions relaxed = options;
  relaxed.distance_min_m *= kRelaxedNear;
  relaxed.distance_max_m *= kRelaxedFar;
  relaxed.bearing_max_deg += kRelaxedBearingDeg;
  for (const InteractionOptions& limits : {options, relaxed}) {
    const std::vector<Candidate> candidates = candidates_for(fronts, served, map, robot, planner, limits);
    add_stops(fronts, candidates, limits, served, stops);
  }
  return stops;
}

namespace {

/// The scans and hand paths of all pulls so far, on disk.
class PullLog {
 public:
  PullLog(fs::path folder, bool resume) : folder_(std::move(folder)) {
    set_.sensor = "hokuyo";
    const fs::path file = folder_ / "pulls.json";
    if (!resume || !fs::exists(file)) return;
    json_ = read_json(file);
    set_ = read_scan_set(folder_);
    // Scans beyond those that the log knows are of a pull that was not finished.
    set_.scans.resize(std::min(set_.scans.size(), json_.at("scans").get<size_t>()));
  }

  const Scan* find(const std::string& name) const {
    for (const Scan& scan : set_.scans)
      if (scan.name == name) return &scan;
    return nullptr;
  }
  const Json* pull(const std::string& front) const {
    const auto found = json_.at("pulls").find(front);
    return found == json_.at("pulls").end() ? nullptr : &*found;
  }
  const Json& robot() const { return json_.at("robot"); }

  void add(Scan scan) {
    set_.scans.push_back(std::move(scan));
    append_to_scan_set(set_, folder_);
  }
  void add_pull(const std::string& front, const std::vector<Isometry3d>& hand_path) {
    Json path = Json::array();
    for (const Isometry3d& pose : hand_path) path.push_back(values_from_pose(pose));
    json_["pulls"][front] = path;
  }
  /// Stops where the robot could not stand.
  bool failed(const std::string& stop) const { return json_.at("failed").contains(stop); }
  void add_failure(const std::string& stop, const std::string& reason) { json_["failed"][stop] = reason; }
  void commit(const Json& robot) {
    json_["scans"] = set_.scans.size();
    json_["robot"] = robot;
    make_folder(folder_);
    write_json(folder_ / "pulls.json", json_);
  }

 private:
  fs::path folder_;
  ScanSet set_;
  Json json_ = {{"version", 1},
                {"pulls", Json::object()},
                {"failed", Json::object()},
                {"scans", 0},
                {"robot", nullptr}};
};

std::vector<Isometry3d> path_from(const Json& json) {
  std::vector<Isometry3d> path;
  for (const Json& pose : json) path.push_back(pose_from_values(pose.get<std::array<double, 7>>()));
  return path;
}

ScanSet set_of(const Scan& scan) {
  ScanSet set;
  set.sensor = "hokuyo";
  set.scans = {scan};
  return set;
}

}  // namespace

namespace {

class Interactor {
 public:
  Interactor(Robot& robot, const Exploration& exploration, const fs::path& folder, bool resume,
             const InteractionOptions& options, Warnings& warnings)
      : robot_(robot),
        exploration_(exploration),
        options_(options),
        warnings_(warnings),
        log_(folder / "interaction", resume) {
    if (!log_.robot().is_null()) robot_.restore(log_.robot());
  }

  /// The scan from a stop with everything closed; nullptr when the robot cannot get there.
  const Scan* closed_scan(size_t number, const InteractionStop& stop) {
    const std::string name = fmt::format("stop_{:02}", number);
    if (log_.failed(name)) return nullptr;
    if (log_.find(name) == nullptr) {
      try {
        Scan scan = robot_.scan_at(stop.pose);
        scan.name = name;
        if (const auto pose = exploration_.locate(scan)) {
          scan.map_from_scan = *pose;
          robot_.localize(planar(*pose));
        } else {
          warnings_.add(fmt::format("{}: the scan could not be registered, odometry was taken", name));
        }
        log_.add(std::move(scan));
        log_.commit(robot_.state());
      } catch (const Error& error) {
        warnings_.add(fmt::format("{} was not reached: {}", name, error.what()));
        log_.add_failure(name, error.what());
        log_.commit(robot_.state());
        return nullptr;
      }
    }
    return log_.find(name);
  }

  Interaction pull(const Front& front, size_t stop, const Scan& closed) {
    const Stopwatch watch;
    Interaction result;
    result.front = front.name;
    result.stop = stop;
    const std::string name = "pull_" + front.name;
    if (log_.pull(front.name) == nullptr) {
      const PullResult pulled = robot_.pull(front.fixture->centre, options_.pull_way_m);
      if (pulled.hand_path.size() > 1) {
        Scan scan = robot_.scan_at(planar(closed.map_from_scan));
        scan.name = name;
        scan.map_from_scan = closed.map_from_scan;  // The robot did not move.
        log_.add(std::move(scan));
      }
      robot_.close_all();
      log_.add_pull(front.name, pulled.hand_path);
      log_.commit(robot_.state());
    }
    const std::vector<Isometry3d> hand_path = path_from(*log_.pull(front.name));
    result.held = !hand_path.empty();
    if (const Scan* open = log_.find(name))
      result.difference = articulate(set_of(closed), set_of(*open), front, hand_path, options_.difference);
    else
      result.difference.reason = result.held ? "it did not give way" : "there was nothing to hold";
    result.seconds = watch.seconds();
    return result;
  }

 private:
  Robot& robot_;
  const Exploration& exploration_;
  const InteractionOptions& options_;
  Warnings& warnings_;
  PullLog log_;
};

/// Puts what the motion showed in the place of what was assumed.
void learn(const Interaction& interaction, Front& front) {
  if (!interaction.held) {
    front.fixture.reset();  // The hand closed on nothing.
    front.joint = joint_prior(front);
    front.class_name = front_class(front, *front.joint);
    front.evidence["pulled"] = interaction.difference.reason;
    return;
  }
  const DifferenceResult& difference = interaction.difference;
  front.evidence["pulled"] = difference.joint ? "it moved" : difference.reason;
  if (!difference.joint) return;
  if (difference.corrected) {
    const Json evidence = front.evidence;
    front = *difference.corrected;
    front.evidence.update(evidence);
  }
  front.joint = difference.joint;
  front.class_name = front_class(front, *front.joint);
}

}  // namespace

std::vector<Interaction> interact(Robot& robot, const Exploration& exploration, std::vector<Front>& fronts,
                                  const fs::path& folder, bool resume, const PlannerOptions& planner,
                                  const InteractionOptions& options, Progress& progress, Warnings& warnings) {
  const PlanarPose here = planar(exploration.registration().map_from_scan.back());
  Interactor interactor(robot, exploration, folder, resume, options, warnings);
  std::vector<Interaction> interactions;
  PlannerOptions where = planner;
  std::vector<Front> left = fronts;  // Those that were pulled lose their fixture here.
  const auto count_left = [&] {
    return static_cast<size_t>(std::count_if(left.begin(), left.end(),
                                             [](const Front& front) { return front.fixture.has_value(); }));
  };
  const size_t wanted = count_left();
  size_t number = 0;
  for (int failures = 0; failures < kFailuresMax;) {
    const std::vector<InteractionStop> stops =
        plan_stops(left, exploration.occupancy(), here, where, options);
    if (stops.empty()) break;
    const InteractionStop& stop = stops.front();
    const Scan* seen = interactor.closed_scan(number, stop);
    ++number;
    if (seen == nullptr) {  // Something stands there that the map does not show: from elsewhere, then.
      where.avoid.emplace_back(stop.pose.x, stop.pose.y);
      ++failures;
      continue;
    }
    const Scan closed = *seen;  // The log grows.
    for (const size_t f : stop.fronts) {
      progress.check(1 - static_cast<double>(count_left()) / static_cast<double>(wanted),
                     "pulls " + fronts[f].name);
      interactions.push_back(interactor.pull(fronts[f], number - 1, closed));
      learn(interactions.back(), fronts[f]);
      left[f].fixture.reset();
    }
  }
  if (count_left() > 0)
    warnings.add(fmt::format("{} of {} handles cannot be seen well from where the robot can stand",
                             count_left(), wanted));
  return interactions;
}

}  // namespace loci
