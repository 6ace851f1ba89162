#include "nbv/interaction.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "mapping/base/files.h"
#include "mapping/base/math/pose.h"
#include "mapping/base/stopwatch.h"
#include "mapping/base/text/json.h"
#include "mapping/interpretation/furniture/furniture_links.h"
#include "mapping/interpretation/furniture/prior_joints.h"

namespace loci::nbv {
namespace {

namespace fs = std::filesystem;

constexpr double kUnsureAxis_deg = 20;  ///< with such a deviation of the axis half of the confidence remains
constexpr int kMaxFailures = 8;         ///< base poses that may turn out to be blocked

/// What pulling at one front gave, as it is kept.
struct LoggedPull {
  std::vector<Isometry3d> hand_path;
  std::string blocked;  ///< why there is no scan of it although it moved
};

Json to_json(const LoggedPull& pull) {
  Json path = Json::array();
  for (const Isometry3d& pose : pull.hand_path) path.push_back(exact_values(pose));
  return {{"hand_path", path}, {"blocked", pull.blocked}};
}

LoggedPull pull_from(const Json& json) {
  LoggedPull pull;
  for (const Json& pose : json.at("hand_path"))
    pull.hand_path.push_back(pose_from_exact(pose.get<std::array<double, 12>>()));
  pull.blocked = json.at("blocked");
  return pull;
}

/// The scans and hand paths of all pulls so far, on disk.
class PullLog {
 public:
  PullLog(fs::path folder, bool resume) : folder_(std::move(folder)) {
    set_.sensor = mapping::kLaserSensor;
    const fs::path file = folder_ / "pulls.json";
    if (!resume || !fs::exists(file)) return;
    json_ = read_json(file);
    if (json_.value("version", 0) != kVersion)
      throw Error("these pulls were logged by another version", {file.string(), 0, "version"},
                  "begin anew without --resume");
    set_ = mapping::read_scan_set(folder_);
    const Json& poses = json_.at("poses");
    // Scans beyond those that the log knows are of a pull that was not finished.
    set_.scans.resize(std::min(set_.scans.size(), poses.size()));
    for (size_t i = 0; i < set_.scans.size(); ++i)
      set_.scans[i].map_from_scan = pose_from_exact(poses[i].get<std::array<double, 12>>());
  }

  const mapping::Scan* find(const std::string& name) const {
    for (const mapping::Scan& scan : set_.scans)
      if (scan.name == name) return &scan;
    return nullptr;
  }
  std::optional<LoggedPull> pull(const std::string& front) const {
    const auto found = json_.at("pulls").find(front);
    return found == json_.at("pulls").end() ? std::nullopt : std::optional(pull_from(*found));
  }
  const Json& robot() const { return json_.at("robot"); }

  void add(mapping::Scan scan) {
    set_.scans.push_back(std::move(scan));
    append_to_scan_set(set_, folder_);
  }
  void add_pull(const std::string& front, const LoggedPull& pull) { json_["pulls"][front] = to_json(pull); }
  /// Base poses that the robot could not reach.
  bool failed(const std::string& pose) const { return json_.at("failed").contains(pose); }
  void add_failure(const std::string& pose, const std::string& reason) { json_["failed"][pose] = reason; }
  void commit(const Json& robot) {
    json_["poses"] = Json::array();
    for (const mapping::Scan& scan : set_.scans) json_["poses"].push_back(exact_values(scan.map_from_scan));
    json_["robot"] = robot;
    make_folder(folder_);
    write_json(folder_ / "pulls.json", json_);
  }

 private:
  static constexpr int kVersion = 3;
  fs::path folder_;
  mapping::ScanSet set_;
  Json json_ = {{"version", kVersion},
                {"pulls", Json::object()},
                {"failed", Json::object()},
                {"poses", Json::array()},
                {"robot", nullptr}};
};

mapping::ScanSet set_of(const mapping::Scan& scan) {
  mapping::ScanSet set;
  set.sensor = mapping::kLaserSensor;
  set.scans = {scan};
  return set;
}

class Interactor {
 public:
  Interactor(mapping::Robot& robot, const Exploration& exploration, const fs::path& folder, bool resume,
             const InteractionOptions& options, Warnings& warnings)
      : robot_(robot),
        exploration_(exploration),
        options_(options),
        warnings_(warnings),
        log_(folder / "interaction", resume) {
    if (!log_.robot().is_null()) robot_.restore(log_.robot());
  }

  /// The scan from a base pose with everything closed; nullptr when the robot cannot get there, or cannot
  /// tell where it is.
  const mapping::Scan* closed_scan(size_t number, const BasePose& base) {
    const std::string name = fmt::format("base_pose_{:02}", number);
    if (log_.failed(name)) return nullptr;
    if (log_.find(name) == nullptr) {
      try {
        mapping::Scan scan = robot_.scan_at(base.pose);
        scan.name = name;
        // Where odometry takes the robot to be, the hand may close beside a handle that is there.
        const auto pose = exploration_.locate(scan);
        if (!pose) throw Error("its scan could not be registered, so that nothing is pulled from there");
        scan.map_from_scan = *pose;
        robot_.localize(mapping::planar(*pose));
        log_.add(std::move(scan));
        log_.commit(robot_.state());
      } catch (const Error& error) {
        warnings_.add(fmt::format("{} is not used: {}", name, error.what()));
        log_.add_failure(name, error.what());
        log_.commit(robot_.state());
        return nullptr;
      }
    }
    return log_.find(name);
  }

  Interaction pull(const mapping::Front& front, size_t base_pose, const mapping::Scan& closed) {
    const Stopwatch watch;
    Interaction result;
    result.pulled_as = front.name;
    result.base_pose = base_pose;
    const std::string name = "pull_" + front.name;
    if (!log_.pull(front.name)) pull_and_scan(front, name, closed);
    const LoggedPull pull = *log_.pull(front.name);
    result.held = !pull.hand_path.empty();
    result.blocked = !pull.blocked.empty();
    if (const mapping::Scan* open = log_.find(name))
      result.difference =
          articulate(set_of(closed), set_of(*open), front, pull.hand_path, options_.difference);
    else
      result.difference.reason = !result.held           ? "there was nothing to hold"
                                 : pull.blocked.empty() ? "it did not give way"
                                                        : "it was not seen open: " + pull.blocked;
    result.seconds = watch.seconds();
    return result;
  }

  /// Whether another front came along with what was pulled.
  bool came_along(const Interaction& pull, const mapping::Front& other, const mapping::Scan& closed) const {
    const mapping::Scan* open = log_.find("pull_" + pull.pulled_as);
    if (open == nullptr || !is_drawer(pull.difference.joint)) return false;
    const mapping::DifferenceResult moved =
        articulate(set_of(closed), set_of(*open), other, {}, options_.difference);
    return is_drawer(moved.joint) &&
           std::abs(moved.moved - pull.difference.moved) < options_.difference.tolerance_m;
  }

 private:
  static bool is_drawer(const std::optional<mapping::JointEstimate>& joint) {
    return joint && joint->type == mapping::ArticulationType::prismatic;
  }

  void pull_and_scan(const mapping::Front& front, const std::string& name, const mapping::Scan& closed) {
    LoggedPull pull;
    pull.hand_path = robot_.pull(front.fixture->centre, options_.pull_distance_m).hand_path;
    if (pull.hand_path.size() > 1) {
      try {
        mapping::Scan scan = robot_.scan_at(mapping::planar(closed.map_from_scan));
        scan.name = name;
        scan.map_from_scan = closed.map_from_scan;  // The robot did not move.
        log_.add(std::move(scan));
      } catch (const Error& error) {  // It opened into the robot.
        warnings_.add(fmt::format("{}: {}", name, error.what()));
        pull.blocked = error.what();
      }
    }
    robot_.close_all();
    log_.add_pull(front.name, pull);
    log_.commit(robot_.state());
  }

  mapping::Robot& robot_;
  const Exploration& exploration_;
  const InteractionOptions& options_;
  Warnings& warnings_;
  PullLog log_;
};

/// The place of a point, or the end of a direction, in the plane of a front: to its right and up.
Vector2d in_plane(const mapping::Front& front, const Vector3d& direction) {
  return {direction.dot(front.right()), direction.dot(front.up)};
}

/// Whether two fronts stand side by side with level bars in line: perhaps one drawer, whose bar was seen in
/// two pieces.
bool has_bar_in_line(const mapping::Front& front, const mapping::Front& other) {
  constexpr double kMaxGap = 0.03;     // m, between fronts: more than any seam
  constexpr double kMaxOffset = 0.02;  // m, across: bar and front are found to a centimetre each
  if (!front.has_level_bar() || !other.has_level_bar() || front.normal.dot(other.normal) < std::sqrt(0.5))
    return false;
  const Vector3d off = other.centre - front.centre, bars = other.fixture->centre - front.fixture->centre;
  const double gap = std::abs(off.dot(front.right())) - (front.width + other.width) / 2;
  return std::abs(gap) < kMaxGap && std::abs(off.dot(front.normal)) < kMaxOffset &&
         std::abs(off.dot(front.up)) < kMaxGap && std::abs(bars.dot(front.up)) < kMaxOffset;
}

/// Extends a front over another one that came along with it, and its bar over what was between their bars.
void unite(mapping::Front& front, const mapping::Front& other) {
  Eigen::AlignedBox2d box;
  for (const auto* one : std::initializer_list<const mapping::Front*>{&front, &other})
    for (const double side : {-0.5, 0.5})
      box.extend(in_plane(front, one->centre - front.centre) + side * Vector2d(one->width, one->height));
  const Vector2d middle = box.center();
  front.width = box.sizes().x();
  front.height = box.sizes().y();
  if (front.fixture) {
    mapping::Fixture& bar = *front.fixture;
    const double along = in_plane(front, other.fixture->centre - bar.centre).x();
    const double low = std::min(-bar.length, 2 * along - other.fixture->length) / 2,
                 high = std::max(bar.length, 2 * along + other.fixture->length) / 2;
    bar.centre += (low + high) / 2 * front.right();
    bar.length = high - low;
  }
  front.centre += middle.x() * front.right() + middle.y() * front.up;
  front.evidence["united_with"] = "what came along when it was pulled";
}

/// Whether nothing but a fixture that turned out to be none made this a front: no seam parts it from others.
bool disproved(const mapping::Front& front) {
  if (front.fixture || !front.evidence.contains("pulled")) return false;
  const Json edges = front.evidence.value("edges", Json::object());
  return std::none_of(edges.begin(), edges.end(), [](const Json& edge) { return edge == "seam"; });
}

/// Puts what the motion showed in the place of what was assumed.
void learn(const Interaction& interaction, mapping::Front& front) {
  if (!interaction.held) {
    front.fixture.reset();  // The hand closed on nothing.
    front.joint.reset();
    front.class_name = "front";
    set_prior_joint(front);
    front.evidence["pulled"] = interaction.difference.reason;
    return;
  }
  const mapping::DifferenceResult& difference = interaction.difference;
  front.evidence["pulled"] = difference.joint ? "it moved" : difference.reason;
  // What its shape suggested is refuted, unless it moved out of sight.
  if (!difference.joint && !interaction.blocked) {
    front.joint.reset();
    front.class_name = "front";
  }
  if (!difference.joint) return;
  if (difference.corrected) {
    const Json evidence = front.evidence;
    front = *difference.corrected;
    front.evidence.update(evidence);
  }
  front.joint = difference.joint;
  // A front whose motion fits many axes is perhaps another one.
  const double unsure = front.joint->axis_sd_deg / kUnsureAxis_deg;
  front.confidence /= 1 + unsure * unsure;
  front.class_name = front_class(front, *front.joint);
}

}  // namespace

void InteractionOptions::declare(OptionTable& table) {
  table.number("pull_distance_m", pull_distance_m, "m", "How far the hand pulls at a handle.", 0.02, 1);
  base_poses.declare(table);
  difference.declare(table);
}

std::vector<Interaction> interact(mapping::Robot& robot, const Exploration& exploration,
                                  std::vector<mapping::Front>& fronts, const fs::path& folder, bool resume,
                                  const ExplorationOptions& explored, const InteractionOptions& options,
                                  Progress& progress, Warnings& warnings) {
  const mapping::FloorRegion within(explored.planner.within);
  const std::vector<mapping::Front> before = fronts;
  std::vector<mapping::Front> left = fronts;  // Those that need not be pulled lose their fixture here.
  std::set<std::string> united;               // with others: these are not in the map
  for (mapping::Front& front : left)
    if (!within.contains(front.centre.head<2>())) front.fixture.reset();
  const auto count_left = [&] {
    return static_cast<size_t>(std::count_if(
        left.begin(), left.end(), [](const mapping::Front& front) { return front.fixture.has_value(); }));
  };
  const size_t wanted = count_left();
  BasePosePlanner planner(exploration.occupancy(),
                          mapping::planar(exploration.registration().map_from_scan.back()), explored.laser,
                          explored.planner, options.base_poses, options.pull_distance_m);
  Interactor interactor(robot, exploration, folder, resume, options, warnings);
  std::vector<Interaction> interactions;
  std::vector<BasePose> bases = planner.plan(left);
  size_t next = 0;
  int failures = 0;
  for (size_t number = 0; next < bases.size() && failures < kMaxFailures; ++number) {
    const BasePose base = bases[next++];
    const mapping::Scan* seen = interactor.closed_scan(number, base);
    if (seen == nullptr) {  // The map does not show what blocks it: plan again without this pose.
      planner.avoid(base.pose);
      bases = planner.plan(left);
      next = 0;
      ++failures;
      continue;
    }
    const mapping::Scan closed = *seen;  // The log grows.
    for (const size_t f : base.fronts) {
      if (!left[f].fixture) continue;  // It came along with another one.
      progress.check(1 - static_cast<double>(count_left()) / static_cast<double>(wanted),
                     "pulls " + fronts[f].name);
      interactions.push_back(interactor.pull(fronts[f], number, closed));
      learn(interactions.back(), fronts[f]);
      left[f].fixture.reset();
      for (size_t other = 0; other < fronts.size(); ++other) {
        if (!left[other].fixture || !has_bar_in_line(before[f], before[other]) ||
            !interactor.came_along(interactions.back(), before[other], closed))
          continue;
        unite(fronts[f], before[other]);
        left[other].fixture.reset();
        united.insert(fronts[other].name);
      }
    }
  }
  std::erase_if(fronts,
                [&](const mapping::Front& front) { return disproved(front) || united.contains(front.name); });
  if (count_left() > 0)
    warnings.add(fmt::format("{} of {} handles cannot be seen well from where the robot can stand",
                             count_left(), wanted));
  return interactions;
}

}  // namespace loci::nbv
