#include "nbv/exploration.h"

#include <fmt/format.h>

#include <octomap/octomap.h>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>

#include "mapping/base/files.h"
#include "mapping/base/math/math.h"
#include "mapping/base/math/pose.h"
#include "mapping/base/stopwatch.h"
#include "mapping/base/text/json.h"

namespace loci::nbv {
namespace {

namespace fs = std::filesystem;

constexpr int kVersion = 4;
/// Scans are inserted again when registration moved one of them by more than this part of a voxel.
constexpr double kReinsertShift = 0.5;
/// Longer paths are driven in stages with a scan at each: odometry alone would lose the robot. Metres.
constexpr double kMaxPath = 5, kStage = 3.5;

Json to_json(const mapping::PlanarPose& pose) {
  return {pose.x, pose.y, pose.yaw / kDegree};
}

mapping::PlanarPose planar_from(const Json& json) {
  return {json.at(0).get<double>(), json.at(1).get<double>(), json.at(2).get<double>() * kDegree};
}

Json to_json(const ExplorationStep& step, size_t index, bool registered, const Json& robot) {
  return {{"scan", index},
          {"goal", to_json(step.goal)},
          {"height", step.height},
          {"odometry", exact_values(step.map_from_scan_odometry)},
          {"reason", step.reason},
          {"expected_overlap", step.expected_overlap},
          {"expected_gain", step.expected_gain},
          {"reached_overlap", step.reached_overlap},
          {"registered", registered},
          {"known_voxels", step.known_voxels},
          {"frontier_voxels", step.frontier_voxels},
          {"seconds",
           {{"scan", step.scan_seconds},
            {"register", step.register_seconds},
            {"insert", step.insert_seconds},
            {"plan", step.plan_seconds}}},
          {"robot", robot}};
}

ExplorationStep step_from(const Json& json) {
  ExplorationStep step;
  step.goal = planar_from(json.at("goal"));
  step.height = json.at("height");
  step.map_from_scan_odometry = pose_from_exact(json.at("odometry").get<std::array<double, 12>>());
  step.reason = json.at("reason");
  step.expected_overlap = json.at("expected_overlap");
  step.expected_gain = json.at("expected_gain");
  const Json& seconds = json.at("seconds");
  step.scan_seconds = seconds.at("scan");
  step.register_seconds = seconds.at("register");
  step.insert_seconds = seconds.at("insert");
  step.plan_seconds = seconds.at("plan");
  return step;
}

/// The pose at a length along a path, heading along it; its end if it is shorter.
mapping::PlanarPose along(const std::vector<mapping::PlanarPose>& corners, double length) {
  for (size_t i = 1; i < corners.size(); ++i) {
    const double dx = corners[i].x - corners[i - 1].x, dy = corners[i].y - corners[i - 1].y;
    const double part = std::hypot(dx, dy);
    if (part >= length && part > 0)
      return {corners[i - 1].x + dx * length / part, corners[i - 1].y + dy * length / part,
              std::atan2(dy, dx)};
    length -= part;
  }
  return corners.back();
}

}  // namespace

void ExplorationOptions::forward_threads() {
  planner.threads = occupancy.threads = registration.threads = threads;
}

void ExplorationOptions::declare(OptionTable& table) {
  table.integer("max_scans", max_scans, "", "Stop after so many scans.", 1, 1000);
  table.integer("max_failures", max_failures, "", "Stop after so many goals in a row that were not reached.",
                1, 100);
  table.text(
      "height", height,
      "Heights to which the robot can move its scanner, LOW..HIGH in m; empty: it is carried at 1.25 m.");
  planner.declare(table);
  inspection.declare(table);
  registration.declare(table);
  occupancy.declare(table);
}

std::vector<double> scanner_heights(const std::string& range, double carried) {
  if (range.empty()) return {carried};
  double low = 0, high = 0;
  int read = 0;
  if (std::sscanf(range.c_str(), "%lf..%lf%n", &low, &high, &read) != 2 ||
      static_cast<size_t>(read) != range.size() ||
      !(low > 0 && low <= carried && carried <= high && high < 5))
    throw Error(
        fmt::format("'{}' is not a range of heights", range), {"height", 0, {}},
        fmt::format("give it as LOW..HIGH in metres, around {} m at which the scanner is carried", carried));
  std::vector<double> heights = {carried};
  if (low < carried) heights.push_back(low);
  if (high > carried) heights.push_back(high);
  return heights;
}

struct Exploration::Impl {
  Impl(mapping::Robot& scanner, const mapping::PlanarPose& begin, fs::path out, ExplorationOptions given,
       Warnings& w)
      : robot(scanner),
        start(begin),
        folder(std::move(out)),
        options((given.forward_threads(), std::move(given))),
        warnings(w),
        random(options.seed),
        registrar(options.registration),
        map(options.occupancy) {
    set.sensor = mapping::kLaserSensor;
    set.levelled = true;
    set.range_max = options.laser.range_max_m;
    options.planner.heights = options.inspection.heights =
        scanner_heights(options.height, options.laser.height_m);
  }

  /// Processes a scan: registers all scans anew and updates the occupancy.
  void take_in(mapping::Scan scan, ExplorationStep& step) {
    Stopwatch watch;
    step.map_from_scan_odometry = scan.map_from_scan;
    scan.name = fmt::format("scan_{:03}", set.scans.size());
    set.scans.push_back(std::move(scan));
    place(registrar.add(set.scans.back()));
    step.reached_overlap = 0;
    for (const mapping::PairAlignment& pair : registrar.result().pairs)
      if (pair.trusted && std::max(pair.source, pair.target) + 1 == set.scans.size())
        step.reached_overlap = std::max(step.reached_overlap, pair.overlap);
    step.register_seconds = watch.lap();
    insert();
    step.insert_seconds = watch.lap();
    step.known_voxels = map.tree().getNumLeafNodes();
  }

  void place(const mapping::RegistrationResult& registered) {
    for (size_t i = 0; i < set.scans.size(); ++i) {
      set.scans[i].map_from_scan = registered.map_from_scan[i];
      set.scans[i].registered = registered.connected[i];
    }
  }

  bool connected(size_t scan) const { return registrar.result().connected[scan]; }

  /// How many of the last scans are not connected.
  size_t trailing_untied() const {
    size_t count = 0;
    while (count < set.scans.size() && !connected(set.scans.size() - 1 - count)) ++count;
    return count;
  }

  /// Aligns the scans that are not connected with the others again, once after a scan: by what was scanned
  /// since, the poses are known better. Whether that connected any.
  bool register_again() {
    const size_t before = registrar.result().connected_count();
    if (before == set.scans.size() || (!retried.empty() && retried.back() == set.scans.size())) return false;
    retried.push_back(set.scans.size());
    place(registrar.retry());
    insert();
    if (connected(set.scans.size() - 1)) robot.localize(robot_pose());
    if (robot_states.size() == set.scans.size()) robot_states.back() = robot.state();
    return registrar.result().connected_count() > before;
  }

  /// Connected scans at their best known poses.
  void insert() {
    const double most = kReinsertShift * map.resolution();
    bool changed = false;
    for (size_t i = 0; i < inserted.size(); ++i)
      changed = changed ||
                (inserted[i] &&
                 (!connected(i) ||
                  (inserted[i]->translation() - set.scans[i].map_from_scan.translation()).norm() > most));
    if (changed) {
      map = mapping::OccupancyMap(options.occupancy);
      inserted.clear();
    }
    inserted.resize(set.scans.size());
    for (size_t i = 0; i < set.scans.size(); ++i) {
      if (inserted[i] || !connected(i)) continue;
      map.insert(set.scans[i]);
      inserted[i] = set.scans[i].map_from_scan;
    }
  }

  /// The map with the last scan, which is not connected: where odometry puts it is good enough to plan the
  /// view that ties it to the others.
  mapping::OccupancyMap with_untied() const {
    mapping::OccupancyMap with = map;
    with.insert(set.scans.back());
    return with;
  }

  ScanRefs placed_scans() const {
    ScanRefs placed;
    for (size_t i = 0; i < set.scans.size(); ++i)
      if (connected(i)) placed.emplace_back(set.scans[i]);
    return placed;
  }

  /// Believed pose of the robot.
  mapping::PlanarPose robot_pose() const { return mapping::planar(set.scans.back().map_from_scan); }

  /// Drives to the goal and scans from a height; false when the robot did not reach it.
  bool scan_at(const mapping::PlanarPose& goal, double height, ExplorationStep step) {
    Stopwatch watch;
    robot.raise_scanner(height);
    std::optional<mapping::Scan> scan;
    try {
      scan = robot.scan_at(goal);
    } catch (const Error& error) {
      if (set.scans.empty())
        throw Error("the exploration cannot start: " + error.message(), error.location(),
                    "give a --start on free floor");
      warnings.add(fmt::format("goal ({:.2f}, {:.2f}) was not reached: {}", goal.x, goal.y, error.what()));
      avoid.emplace_back(goal.x, goal.y);
      return false;
    }
    step.goal = goal;
    step.height = height;
    step.scan_seconds = watch.lap();
    take_in(std::move(*scan), step);
    // Beside scans that are not connected themselves the robot is as lost as they are.
    if (connected(set.scans.size() - 1)) robot.localize(robot_pose());
    steps.push_back(std::move(step));
    robot_states.push_back(robot.state());
    checkpoint();
    return true;
  }

  void checkpoint() const {
    append_to_scan_set(set, folder / "scans");
    write_json(folder / "explore.json", report());
  }

  Json configuration() const {
    ExplorationOptions effective = options;
    Json json = table_of(effective).to_json();
    json["seed"] = options.seed;
    return json;
  }

  Json report() const {
    Json list = Json::array();
    for (size_t i = 0; i < steps.size(); ++i)
      list.push_back(to_json(steps[i], i, connected(i), robot_states[i]));
    Json places = Json::array();
    for (const Vector2d& place : avoid) places.push_back({place.x(), place.y()});
    return {{"version", kVersion},
            {"start", to_json(start)},
            {"finished", !stop_reason.empty()},
            {"stop_reason", stop_reason},
            {"steps", list},
            {"not_reached", places},
            {"registered_again_after", retried},
            {"configuration", configuration()}};
  }

  void resume() {
    const fs::path file = folder / "explore.json";
    if (!fs::exists(file)) return;  // Killed before the first scan was whole.
    const Json json = read_json(file);
    if (json.value("version", 0) != kVersion || json.at("configuration") != configuration() ||
        json.at("start") != to_json(start))
      throw Error("this exploration was begun with other options", {file.string(), 0, ""},
                  "give the same options, or leave --resume away to begin anew");
    mapping::ScanSet before = mapping::read_scan_set(folder / "scans");
    const Json& list = json.at("steps");
    const auto again = json.at("registered_again_after").get<std::vector<size_t>>();
    if (before.scans.size() < list.size())
      throw Error("there are fewer scans than steps", {file.string(), 0, "steps"},
                  "begin anew without --resume");
    for (size_t i = 0; i < list.size(); ++i) {
      ExplorationStep step = step_from(list[i]);
      const double seconds = step.register_seconds;
      mapping::Scan scan = std::move(before.scans[i]);
      scan.map_from_scan = step.map_from_scan_odometry;
      take_in(std::move(scan), step);
      if (std::find(again.begin(), again.end(), set.scans.size()) != again.end()) register_again();
      step.register_seconds = seconds;
      step.frontier_voxels = list[i].at("frontier_voxels");
      steps.push_back(std::move(step));
      robot_states.push_back(list[i].at("robot"));
    }
    if (!robot_states.empty()) robot.restore(robot_states.back());
    for (const Json& place : json.at("not_reached"))
      avoid.emplace_back(place.at(0).get<double>(), place.at(1).get<double>());
    stop_reason = json.at("stop_reason");
  }

  /// A pose on a path that is too long to drive at once, heading along it.
  std::optional<mapping::PlanarPose> stage_of(const std::vector<mapping::PlanarPose>& path) const {
    double length = 0;
    std::vector<mapping::PlanarPose> corners = {robot_pose()};
    for (const mapping::PlanarPose& corner : path) {
      length += std::hypot(corner.x - corners.back().x, corner.y - corners.back().y);
      corners.push_back(corner);
    }
    if (length <= kMaxPath) return std::nullopt;
    PlannerOptions planner = options.planner;
    planner.avoid = avoid;
    // Positions that the robot failed to reach are skipped.
    for (double at = std::min(kStage, length / 2); at < length; at += planner.robot_radius_m) {
      const mapping::PlanarPose stage = along(corners, at);
      if (!avoided({stage.x, stage.y}, planner)) return stage;
    }
    return std::nullopt;
  }

  /// Everything is covered: a view for the sake of faces that were seen too coarsely, if there are any.
  void inspect(const PlannerOptions& planner, NextView& view) const {
    const NextView closer =
        inspection_view(placed_scans(), map, robot_pose(), options.laser, planner, options.inspection);
    view.pose = closer.pose;
    view.height_m = closer.height_m;
    view.path = closer.path;
    view.expected_overlap = closer.expected_overlap;
    view.expected_gain = closer.expected_gain;
    view.reason = closer.pose ? closer.reason : view.reason + "; " + closer.reason;
  }

  /// What the next view is for.
  enum class Purpose { explore, tie, turn_back };

  /// What to try, in this order. After a scan that could not be registered (two that face each other share
  /// but parallel walls, along which they may slide) a view comes first that sees as much as possible of what
  /// is known: it ties them together. When that fails, too, the robot looks once more at what the connected
  /// scans show, and goes on from there.
  std::vector<Purpose> purposes() const {
    const size_t untied = trailing_untied();
    if (untied == 0) return {Purpose::explore};
    if (untied == 1) return {Purpose::tie, Purpose::explore};
    if (untied % 2 == 0) return {Purpose::turn_back, Purpose::tie, Purpose::explore};
    return {Purpose::explore, Purpose::tie};
  }

  ViewPlan plan_for(Purpose purpose, int attempt) {
    PlannerOptions planner = options.planner;
    planner.avoid = avoid;
    if (purpose != Purpose::explore) planner.heights.clear();
    // Another scan from there would not be connected either.
    for (size_t i = 0; i < set.scans.size() && purpose != Purpose::tie; ++i)
      if (!connected(i)) planner.avoid.emplace_back(set.scans[i].map_from_scan.translation().head<2>());
    if (purpose != Purpose::explore) planner.gain_weight = planner.min_gain = 0;
    std::optional<mapping::OccupancyMap> with;
    if (purpose == Purpose::tie) with = with_untied();
    ViewPlan plan = plan_view(with ? *with : map, robot_pose(), options.laser, planner,
                              random.fork(steps.size()).fork(static_cast<uint64_t>(attempt)));
    if (!plan.view.pose && purpose == Purpose::explore && options.inspection.points_per_cm2 > 0)
      inspect(planner, plan.view);
    if (!plan.view.pose) return plan;
    if (purpose == Purpose::tie) plan.view.reason = "ties the scan before to the others: " + plan.view.reason;
    if (purpose == Purpose::turn_back)
      plan.view.reason = "turns back to what is connected: " + plan.view.reason;
    return plan;
  }

  /// Plans the next view and goes there, or says why it ends here.
  void plan_and_scan() {
    if (!connected(set.scans.size() - 1)) register_again();
    for (int attempt = 0; attempt < options.max_failures; ++attempt) {
      Stopwatch watch;
      ViewPlan plan;
      for (const Purpose purpose : purposes())
        if (plan = plan_for(purpose, attempt); plan.view.pose) break;
      const NextView& view = plan.view;
      steps.back().plan_seconds += watch.lap();
      steps.back().frontier_voxels = view.frontier_voxels;
      if (watcher) watcher(steps.size() - 1, plan, robot_pose());
      if (!view.pose) {
        if (!register_again()) stop_reason = view.reason;
        return;
      }
      ExplorationStep step;
      step.reason = view.reason;
      step.expected_overlap = view.expected_overlap;
      step.expected_gain = view.expected_gain;
      const std::optional<mapping::PlanarPose> stage = stage_of(view.path);
      if (stage) step.reason = "stage: " + step.reason;
      const double carried = options.laser.height_m;
      if (scan_at(stage.value_or(*view.pose), stage ? carried : view.height_m.value_or(carried),
                  std::move(step)))
        return;
    }
    stop_reason = fmt::format("{} goals in a row could not be reached", options.max_failures);
  }

  void run(Progress& progress) {
    if (steps.empty()) {
      progress.check(0, "first scan");
      ExplorationStep first;
      first.reason = "start";
      scan_at(start, options.laser.height_m, std::move(first));
    }
    while (stop_reason.empty()) {
      const double most = static_cast<double>(options.max_scans);
      progress.check(std::min(0.99, static_cast<double>(steps.size()) / most),
                     fmt::format("{} scans; the last one: {}", steps.size(), steps.back().reason));
      if (steps.size() >= static_cast<size_t>(options.max_scans))
        stop_reason = fmt::format("the maximum number of scans ({})", options.max_scans);
      else
        plan_and_scan();
    }
    robot.raise_scanner(options.laser.height_m);
    register_again();
    for (size_t i = 0; i < set.scans.size(); ++i)
      if (!connected(i)) warnings.add(fmt::format("scan {} could not be registered and is left out", i));
    checkpoint();
  }

  mapping::Robot& robot;
  mapping::PlanarPose start;
  fs::path folder;
  ExplorationOptions options;
  Warnings& warnings;
  Random random;
  mapping::IncrementalRegistration registrar;
  mapping::OccupancyMap map;
  mapping::ScanSet set;
  std::vector<std::optional<Isometry3d>> inserted;  ///< poses at which scans are in the map; unset = left out
  std::vector<ExplorationStep> steps;
  std::vector<Json> robot_states;
  std::vector<Vector2d> avoid;  ///< goals that were not reached
  std::vector<size_t> retried;  ///< numbers of scans after which they were registered again
  std::string stop_reason;
  Watcher watcher;  ///< may be empty
};

Exploration::Exploration(mapping::Robot& robot, const mapping::PlanarPose& start, fs::path folder,
                         bool resume, const ExplorationOptions& options, Warnings& warnings)
    : impl_(std::make_unique<Impl>(robot, start, std::move(folder), options, warnings)) {
  if (resume) impl_->resume();
}

Exploration::~Exploration() = default;

void Exploration::run(Progress& progress) {
  impl_->run(progress);
}

void Exploration::watch_plans(Watcher watcher) {
  impl_->watcher = std::move(watcher);
}

mapping::ScanSet Exploration::registered_scans() const {
  const mapping::ScanSet& all = impl_->set;
  mapping::ScanSet registered{all.sensor, all.levelled, all.range_max, all.resolution, all.free_space, {}};
  const ScanRefs placed = impl_->placed_scans();
  registered.scans.assign(placed.begin(), placed.end());
  return registered;
}

std::optional<Isometry3d> Exploration::locate(const mapping::Scan& scan) const {
  constexpr size_t kNearest = 3;
  std::vector<std::pair<double, size_t>> near;
  for (size_t i = 0; i < impl_->set.scans.size(); ++i)
    if (impl_->connected(i))
      near.emplace_back(
          (impl_->set.scans[i].map_from_scan.translation() - scan.map_from_scan.translation()).norm(), i);
  std::sort(near.begin(), near.end());
  if (near.size() > kNearest) near.resize(kNearest);
  std::optional<Isometry3d> best;
  double most = 0;
  for (const auto& [distance, i] : near) {
    const mapping::Scan& target = impl_->set.scans[i];
    const mapping::PairAlignment pair =
        align(target, scan, target.map_from_scan.inverse() * scan.map_from_scan, impl_->options.registration);
    if (!pair.trusted || pair.overlap <= most) continue;
    most = pair.overlap;
    best = target.map_from_scan * pair.target_from_source;
  }
  return best;
}

const mapping::OccupancyMap& Exploration::occupancy() const {
  return impl_->map;
}
const mapping::RegistrationResult& Exploration::registration() const {
  return impl_->registrar.result();
}
const std::vector<ExplorationStep>& Exploration::steps() const {
  return impl_->steps;
}
const std::string& Exploration::stop_reason() const {
  return impl_->stop_reason;
}
Json Exploration::report() const {
  return impl_->report();
}

}  // namespace loci::nbv
