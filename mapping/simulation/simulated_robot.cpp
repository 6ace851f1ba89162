#include "mapping/simulation/simulated_robot.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

#include "mapping/base/math/math.h"
#include "mapping/base/math/pose.h"
#include "mapping/base/math/rotation_vector.h"
#include "mapping/base/text/json.h"
#include "mapping/world/inspection.h"
#include "mapping/world/kinematics.h"
#include "mapping/world/urdf.h"
#include "mapping/world/world_triangles.h"

namespace loci::mapping {
namespace {

namespace fs = std::filesystem;

constexpr double kRobotRadius = 0.25, kRobotBottom = 0.05, kRobotTop = 1.3, kScannerMargin = 0.05;
constexpr double kReach = 0.05;     ///< of the gripper around the point that it is sent to
constexpr double kHandStep = 0.01;  ///< of the hand path, metres

constexpr uint64_t kHandStream = uint64_t{1} << 40;  ///< of random numbers; scans have the low ones

using Covariance = Eigen::Matrix<double, 6, 6>;

/// Of a pose after a move, from that before and that of the move (x, y and yaw only).
Covariance compounded(const Covariance& before, const Isometry3d& map_from_before, const Covariance& motion,
                      const Isometry3d& before_from_after) {
  const Vector3d way = map_from_before.linear() * before_from_after.translation();
  Covariance lever = Covariance::Identity();  // A turned start moves the end sideways.
  lever(0, 5) = -way.y();
  lever(1, 5) = way.x();
  Covariance turned = Covariance::Identity();
  turned.topLeftCorner<3, 3>() = map_from_before.linear();
  return lever * before * lever.transpose() + turned * motion * turned.transpose();
}

TriangleMesh level_rectangle(const Eigen::AlignedBox3d& box, double height, bool face_up) {
  TriangleMesh mesh;
  const auto z = static_cast<float>(height);
  const Eigen::Vector3f a = box.min().cast<float>(), b = box.max().cast<float>();
  mesh.vertices = {{a.x(), a.y(), z}, {b.x(), a.y(), z}, {b.x(), b.y(), z}, {a.x(), b.y(), z}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  if (!face_up) mesh.triangles = {{0, 2, 1}, {0, 3, 2}};
  return mesh;
}

/// Positions that a joint can take.
std::pair<double, double> range_of(const Joint& joint) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  if (joint.type == JointType::continuous) return {-infinity, infinity};
  if (joint.type != JointType::revolute && joint.type != JointType::prismatic) return {0, 0};
  if (!joint.limits) return {-infinity, infinity};
  return {joint.limits->lower, joint.limits->upper};
}

constexpr double kOpenFloor = 3;  // m, of the floor that is added round a world without walls

/// Places that walls enclose, each with the distance to the nearest surface, less by openings.
std::vector<std::pair<double, PlanarPose>> places_inside(const RayScene& scene, const LaserModel& laser) {
  constexpr double kStep = 0.2;
  constexpr int kDirections = 24;
  const Eigen::AlignedBox3d box = scene.bounds();
  std::vector<std::pair<double, PlanarPose>> places;
  for (double y = box.min().y(); y <= box.max().y(); y += kStep) {
    for (double x = box.min().x(); x <= box.max().x(); x += kStep) {
      double clearance = std::numeric_limits<double>::infinity();
      int walled = 0;
      for (int i = 0; i < kDirections; ++i) {
        const double angle = 2 * kPi * i / kDirections;
        const Eigen::Vector3f along(static_cast<float>(std::cos(angle)), static_cast<float>(std::sin(angle)),
                                    0);
        for (const double height : {0.15, 0.5, 0.85, laser.height_m}) {
          const RayHit hit =
              scene.cast(Vector3d(x, y, height).cast<float>(), along, static_cast<float>(laser.range_max_m));
          clearance = std::min(clearance, static_cast<double>(hit.distance));
          if (height == laser.height_m && hit.link >= 0) ++walled;
        }
      }
      // Outside there is more room still, but walls at most on one side; windows let rays out of a room.
      const double enclosed = static_cast<double>(walled) / kDirections;
      if (enclosed > 0.6) places.push_back({clearance * enclosed, {x, y, 0}});
    }
  }
  return places;
}

/// Places round furniture that no walls enclose, from which the robot looks at its middle; nearest the
/// distance from which it shows well first.
std::vector<std::pair<double, PlanarPose>> places_beside(const Eigen::AlignedBox3d& box) {
  constexpr double kDistance = 1.2;  // m, from what is scanned
  constexpr int kSides = 16;
  std::vector<std::pair<double, PlanarPose>> places;
  const Vector3d middle = box.center();
  const Vector2d reach = box.sizes().head<2>() / 2 + Vector2d::Constant(kDistance);
  for (int i = 0; i < kSides; ++i) {
    // From the long sides first: fronts and the most of a top are seen from there.
    const double angle = 2 * kPi * i / kSides - (reach.x() < reach.y() ? 0 : kPi / 2);
    const Vector2d out(std::cos(angle), std::sin(angle));
    const Vector2d at = middle.head<2>() + out / (out.cwiseQuotient(reach)).cwiseAbs().maxCoeff();
    places.push_back({-(at - middle.head<2>()).norm(), {at.x(), at.y(), std::atan2(-out.y(), -out.x())}});
  }
  return places;
}

}  // namespace

std::optional<double> floor_of_world(const std::string& asked, const fs::path& urdf,
                                     const std::vector<fs::path>& package_paths, Warnings& warnings) {
  if (asked == "none") return std::nullopt;
  if (asked != "auto") {
    double height = 0;
    const auto [end, error] = std::from_chars(asked.data(), asked.data() + asked.size(), height);
    if (error == std::errc() && end == asked.data() + asked.size() && std::isfinite(height)) return height;
    throw Error(fmt::format("'{}' is not the height of a floor", asked), {},
                "give --floor auto, none, or metres");
  }
  Warnings later;  // The robot reads the world again.
  const World world = read_urdf(urdf, later);
  const std::vector<WorldTriangle> triangles =
      triangles_of(world, {package_paths, urdf.parent_path()}, later);
  if (const auto height = floor_height(world, triangles)) return is_at_zero(*height) ? 0 : *height;
  double lowest = 0;
  for (const WorldTriangle& triangle : triangles)
    for (const Vector3d& corner : triangle.corners) lowest = std::min(lowest, corner.z());
  if (!is_at_zero(lowest))
    warnings.add(
        fmt::format("the floor is taken to lie at 0, but the world reaches down to {:.2f} m; --floor "
                    "sets its height",
                    lowest),
        {urdf.string(), 0, {}});
  return 0;
}

struct SimulatedRobot::Impl {
  SimulatedRobotOptions options;
  World world;
  Isometry3d map_from_world;
  JointState joints;
  RayScene scene;
  Eigen::AlignedBox3d world_box;                ///< without an added floor and ceiling
  Isometry3d map_from_true, map_from_believed;  ///< the robot's base
  Covariance covariance = Covariance::Zero();
  double scanner_height;
  Random random;
  size_t scans = 0, pulls = 0;

  Impl(const fs::path& urdf, const SimulatedRobotOptions& chosen, const PlanarPose& start, Warnings& warnings)
      : options(chosen),
        world(read_urdf(urdf, warnings)),
        map_from_world(Eigen::Translation3d(0, 0, -chosen.floor.value_or(0))),
        map_from_true(map_from_base(start)),
        map_from_believed(map_from_base(start)),
        scanner_height(chosen.laser.height_m),
        random(chosen.seed) {
    scene.add(world, {options.package_paths, urdf.parent_path()}, map_from_world, warnings);
    const Eigen::AlignedBox3d box = scene.bounds();
    if (box.isEmpty()) throw Error("the world has nothing that a laser can see", {urdf.string(), 0, {}});
    require_metres(box, urdf.string());
    world_box = box;
    const auto missing = [&](const char* name) { return world.find_link(name) == nullptr; };
    if (options.floor && missing("floor")) {
      // Without walls the robot goes round what is there.
      Vector3d around = Vector3d::Zero();
      if (places_inside(scene, options.laser).empty()) around = {kOpenFloor, kOpenFloor, 0};
      scene.add("floor", level_rectangle({box.min() - around, box.max() + around}, *options.floor, true),
                map_from_world);
    }
    if (options.ceiling && missing("ceiling"))
      scene.add("ceiling", level_rectangle(box, *options.ceiling, false), map_from_world);
  }

  Isometry3d base_from_scanner() const {
    Isometry3d pose = Isometry3d::Identity();
    pose.translation().z() = scanner_height;
    return pose;
  }
  const Joint* moving_joint(const std::string& link) const;
  /// Where a point of a link is with a joint at a position and all others as they are.
  Isometry3d map_from_link(size_t link, const Joint& joint, double position) const;
  double opening_direction(const Joint& joint, size_t link, const Vector3d& link_point,
                           const Vector3d& hand) const;
  void move_along(const Joint& joint, size_t link, const Isometry3d& map_from_hand, double max_distance_m,
                  PullResult& result);
  /// A pose of the hand as the arm measures it.
  Isometry3d measured_hand(const Isometry3d& map_from_hand, Random& drawn) const;
};

Isometry3d SimulatedRobot::Impl::measured_hand(const Isometry3d& map_from_hand, Random& drawn) const {
  Isometry3d measured = map_from_believed * map_from_true.inverse() * map_from_hand;
  Vector3d shift, turn;
  for (int k = 0; k < 3; ++k) shift[k] = drawn.normal(options.hand.position_sigma_m);
  for (int k = 0; k < 3; ++k) turn[k] = drawn.normal(options.hand.orientation_sigma_deg * kDegree);
  measured.translation() += shift;
  measured.rotate(rotation_from_vector(turn));
  return measured;
}

/// The nearest joint above a link that moves it, or the one that this mimics; nullptr = it stands firm.
const Joint* SimulatedRobot::Impl::moving_joint(const std::string& link) const {
  for (const Joint* joint = world.parent_joint(link); joint != nullptr;
       joint = world.parent_joint(joint->parent)) {
    const Joint* master = joint;
    for (size_t i = 0; master != nullptr && master->mimic && i < world.joints.size(); ++i)
      master = world.find_joint(master->mimic->joint);
    if (master == nullptr) continue;
    const auto [lower, upper] = range_of(*master);
    if (lower < upper) return master;
  }
  return nullptr;
}

Isometry3d SimulatedRobot::Impl::map_from_link(size_t link, const Joint& joint, double position) const {
  JointState state = joints;
  state[joint.name] = position;
  return map_from_world * root_from_links(world, state)[link];
}

/// +1 or -1; 0 = it is open as far as it goes.
double SimulatedRobot::Impl::opening_direction(const Joint& joint, size_t link, const Vector3d& link_point,
                                               const Vector3d& hand) const {
  constexpr double tiny = 1e-6;
  const auto [lower, upper] = range_of(joint);
  const auto at = joints.find(joint.name);
  const double position = at == joints.end() ? 0 : at->second;
  const bool up = upper > std::max(position, 0.) + tiny, down = lower < std::min(position, 0.) - tiny;
  if (up != down) return up ? 1 : -1;
  if (!up) return 0;
  const Vector3d change = map_from_link(link, joint, position + 1e-3) * link_point - hand;
  return change.dot(map_from_true.translation() - hand) >= 0 ? 1 : -1;
}

void SimulatedRobot::Impl::move_along(const Joint& joint, size_t link, const Isometry3d& map_from_hand,
                                      double max_distance_m, PullResult& result) {
  const Isometry3d link_from_hand = scene.map_from_link(link).inverse() * map_from_hand;
  Isometry3d map_from_hand_now = map_from_hand;
  const auto [lower, upper] = range_of(joint);
  const double start = joints.contains(joint.name) ? joints.at(joint.name) : 0;
  const double direction =
      opening_direction(joint, link, link_from_hand.translation(), map_from_hand.translation());
  if (direction == 0) return;
  const auto hand_at = [&](double position) {
    return Isometry3d(map_from_link(link, joint, position) * link_from_hand);
  };
  double position = start, gone = 0;
  while (gone < max_distance_m - 1e-9) {
    constexpr double probe = 1e-4;
    const Vector3d hand = map_from_hand_now.translation();
    const double speed = (hand_at(position + direction * probe).translation() - hand).norm() / probe;
    if (speed < 1e-3) break;  // Held on the hinge itself.
    const double next =
        std::clamp(position + direction * std::min(kHandStep, max_distance_m - gone) / speed, lower, upper);
    if (next == position) break;
    map_from_hand_now = hand_at(next);
    gone += (map_from_hand_now.translation() - hand).norm();
    result.hand_path.push_back(map_from_hand_now);
    position = next;
  }
  if (position == start) return;
  result.joint = joint.name;
  result.moved = std::abs(position - start);
  joints[joint.name] = position;
  scene.set_joints(0, joints);
}

SimulatedRobot::SimulatedRobot(const fs::path& urdf, const SimulatedRobotOptions& options,
                               const PlanarPose& start, Warnings& warnings)
    : impl_(std::make_unique<Impl>(urdf, options, start, warnings)) {}
SimulatedRobot::~SimulatedRobot() = default;

Scan SimulatedRobot::scan_at(const PlanarPose& goal) {
  Impl& robot = *impl_;
  const size_t number = robot.scans;
  Random drawn = robot.random.fork(2 * number);
  const Isometry3d motion = robot.map_from_believed.inverse() * map_from_base(goal);
  const Isometry3d map_from_true = robot.map_from_true * robot.options.odometry.measured(motion, drawn);
  const int blocking =
      robot.scene.link_in_cylinder(map_from_true.translation().head<2>(), kRobotRadius, kRobotBottom,
                                   std::max(kRobotTop, robot.scanner_height + kScannerMargin));
  if (blocking >= 0)
    throw Error(fmt::format("the robot cannot stand at ({:.2f}, {:.2f}): '{}' is in the way", goal.x, goal.y,
                            robot.scene.link_names()[static_cast<size_t>(blocking)]));
  robot.covariance = compounded(robot.covariance, robot.map_from_believed,
                                robot.options.odometry.covariance(motion), motion);
  robot.map_from_true = map_from_true;
  robot.map_from_believed = map_from_base(goal);
  ++robot.scans;

  Scan scan = simulate_sweep(robot.scene, true_map_from_scanner(), robot.options.laser,
                             robot.random.fork(2 * number + 1), robot.options.threads);
  scan.name = fmt::format("scan_{:03}", number);
  scan.map_from_scan = robot.map_from_believed * robot.base_from_scanner();
  scan.covariance = robot.covariance;
  return scan;
}

void SimulatedRobot::raise_scanner(double height_m) {
  impl_->scanner_height = height_m;
}

void SimulatedRobot::localize(const PlanarPose& pose) {
  impl_->map_from_believed = map_from_base(pose);
  impl_->covariance.setZero();
}

PullResult SimulatedRobot::pull(const Vector3d& believed_point, double max_distance_m) {
  Impl& robot = *impl_;
  PullResult result;
  const Vector3d point = robot.map_from_true * (robot.map_from_believed.inverse() * believed_point);
  const NearestSurface held = robot.scene.nearest(point, kReach);
  if (held.link < 0) return result;
  const auto link = static_cast<size_t>(held.link);
  result.link = robot.scene.link_names()[link];
  const Vector3d towards = held.point - robot.map_from_true.translation();
  Isometry3d map_from_hand = map_from_base({0, 0, std::atan2(towards.y(), towards.x())});
  map_from_hand.translation() = held.point;
  result.hand_path = {map_from_hand};
  const bool added = link >= robot.world.links.size();  // The floor or the ceiling.
  if (const Joint* joint = added ? nullptr : robot.moving_joint(result.link))
    robot.move_along(*joint, link, map_from_hand, max_distance_m, result);
  Random drawn = robot.random.fork(kHandStream).fork(robot.pulls++);
  for (Isometry3d& pose : result.hand_path) pose = robot.measured_hand(pose, drawn);
  return result;
}

void SimulatedRobot::set_joints(const JointState& state) {
  JointState joints = impl_->joints;
  for (const auto& [name, position] : state) {
    const Joint* joint = impl_->world.find_joint(name);
    if (joint != nullptr) {
      const auto [lower, upper] = range_of(*joint);
      if (!(position >= lower && position <= upper))
        throw Error(
            fmt::format("joint '{}' cannot be at {}: it goes from {} to {}", name, position, lower, upper));
    }
    joints[name] = position;
  }
  impl_->scene.set_joints(0, joints);  // Error for a joint that is not there.
  impl_->joints = joints;
}

void SimulatedRobot::close_all() {
  impl_->joints.clear();
  impl_->scene.set_joints(0, {});
}

Json SimulatedRobot::state() const {
  return {{"map_from_true", exact_values(impl_->map_from_true)},
          {"map_from_believed", exact_values(impl_->map_from_believed)},
          {"scanner_height", impl_->scanner_height},
          {"covariance", std::vector<double>(impl_->covariance.data(), impl_->covariance.data() + 36)},
          {"joints", impl_->joints},
          {"scans", impl_->scans},
          {"pulls", impl_->pulls}};
}

void SimulatedRobot::restore(const Json& state) {
  const auto pose = [&](const char* key) {
    return pose_from_exact(state.at(key).get<std::array<double, 12>>());
  };
  impl_->map_from_true = pose("map_from_true");
  impl_->map_from_believed = pose("map_from_believed");
  impl_->scanner_height = state.at("scanner_height");
  impl_->covariance = Eigen::Map<const Covariance>(state.at("covariance").get<std::vector<double>>().data());
  impl_->joints = state.at("joints").get<JointState>();
  impl_->scans = state.at("scans");
  impl_->pulls = state.at("pulls");
  impl_->scene.set_joints(0, impl_->joints);
}

void SimulatedRobot::put_at(const PlanarPose& pose) {
  impl_->map_from_true = impl_->map_from_believed = map_from_base(pose);
  impl_->covariance.setZero();
}

PlanarPose SimulatedRobot::open_place() const {
  constexpr double kRoom = 0.4;
  const RayScene& scene = impl_->scene;
  std::vector<std::pair<double, PlanarPose>> places = places_inside(scene, impl_->options.laser);
  if (places.empty()) places = places_beside(impl_->world_box);
  std::stable_sort(places.begin(), places.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  for (const auto& [clearance, place] : places)  // Rays pass over and under a table's top.
    if (scene.link_in_cylinder({place.x, place.y}, kRoom, kRobotBottom, kRobotTop) < 0) return place;
  throw Error("no place in the world is open enough to start from", {}, "give --start");
}

PlanarPose SimulatedRobot::true_pose() const {
  return planar(impl_->map_from_true);
}

Isometry3d SimulatedRobot::true_map_from_scanner() const {
  return impl_->map_from_true * impl_->base_from_scanner();
}

const RayScene& SimulatedRobot::scene() const {
  return impl_->scene;
}

const Isometry3d& SimulatedRobot::map_from_world() const {
  return impl_->map_from_world;
}

const World& SimulatedRobot::world() const {
  return impl_->world;
}

const JointState& SimulatedRobot::joints() const {
  return impl_->joints;
}

}  // namespace loci::mapping
