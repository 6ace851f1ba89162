#include "mapping/update/update.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "mapping/base/files.h"
#include "mapping/base/math/math.h"
#include "mapping/simulation/simulated_robot.h"
#include "mapping/update/placement.h"
#include "mapping/world/urdf.h"

namespace loci::mapping {
namespace {

namespace fs = std::filesystem;

Isometry3d planar_motion(double x, double y, double yaw_deg, const Vector3d& about) {
  Isometry3d motion = Isometry3d::Identity();
  motion.linear() = Eigen::AngleAxisd(yaw_deg * kDegree, Vector3d::UnitZ()).toRotationMatrix();
  motion.translation() = about + Vector3d(x, y, 0) - motion.linear() * about;
  return motion;
}

/// The sample kitchen, in which furniture is moved about.
class Kitchen {
 public:
  Kitchen() : world_(read_urdf(fs::path(LOCI_SOURCE_DIR) / "apps/samples/kitchen.urdf")) {}

  /// Moves a link that hangs on the root.
  void move(const std::string& link, const Isometry3d& now_from_before) {
    for (Joint& joint : world_.joints)
      if (joint.child == link) joint.parent_from_joint = now_from_before * joint.parent_from_joint;
  }

  void add_crate(const Isometry3d& map_from_crate) {
    add("crate", {{{0, 0, 0.135}, {0.4, 0.3, 0.27}}}, map_from_crate);
  }

  void add_chair(const Vector2d& at) { add_chair(Isometry3d(Eigen::Translation3d(at.x(), at.y(), 0))); }
  void add_chair(const Isometry3d& map_from_chair) {
    std::vector<std::pair<Vector3d, Vector3d>> boxes = {{{0, 0, 0.45}, {0.42, 0.42, 0.03}},
                                                        {{-0.2, 0, 0.74}, {0.025, 0.4, 0.28}}};
    for (const double x : {-0.19, 0.19})
      for (const double y : {-0.18, 0.18}) boxes.push_back({{x, y, 0.22}, {0.03, 0.03, 0.44}});
    add("chair_" + std::to_string(++chairs_), boxes, map_from_chair);
  }
  /// Scans from corners of the free floor, with exact poses and a coarse laser.
  ScanSet scans(uint64_t seed, const JointState& joints = {}) const {
    return scans(
        seed, joints,
        {{1.0, 1.5, 0}, {1.0, 1.5, kPi}, {2.2, 1.7, kPi / 2}, {3.1, 1.4, -2.2}, {2.2, 1.6, -kPi / 2}});
  }
  ScanSet scans(uint64_t seed, const JointState& joints, const std::vector<PlanarPose>& poses) const {
    const fs::path urdf = fs::temp_directory_path() / fmt::format("loci_update_{}.urdf", ::getpid());
    write_urdf(world_, urdf);
    SimulatedRobotOptions options;
    options.laser.azimuth_step_deg = options.laser.tilt_step_deg = 0.5;
    options.odometry = {0, 0, 0};
    options.ceiling = 2.5;
    options.seed = seed;
    Warnings warnings;
    SimulatedRobot robot(urdf, options, poses.front(), warnings);
    robot.set_joints(joints);
    ScanSet set;
    set.sensor = "hokuyo";
    set.range_max = options.laser.range_max_m;
    for (const PlanarPose& pose : poses) set.scans.push_back(robot.scan_at(pose));
    fs::remove(urdf);
    return set;
  }

 private:
  /// A link of boxes, by centre and size, that stands in the room.
  void add(const std::string& name, const std::vector<std::pair<Vector3d, Vector3d>>& boxes,
           const Isometry3d& map_from_link) {
    Link link{.name = name, .visuals = {}, .collisions = {}, .inertial = {}};
    for (const auto& [centre, size] : boxes) {
      Visual visual;
      visual.link_from_visual.translation() = centre;
      visual.geometry = Box{size};
      visual.material = Material{"wood", Rgba(0.5F, 0.35F, 0.2F, 1), ""};
      link.visuals.push_back(visual);
    }
    Joint joint;
    joint.name = name + "_joint";
    joint.parent = world_.root;
    joint.child = name;
    joint.parent_from_joint = map_from_link;
    world_.links.push_back(link);
    world_.joints.push_back(joint);
  }

  World world_;
  int chairs_ = 0;
};

InterpretedMap interpreted(const ScanSet& scans) {
  NoProgress progress;
  return interpret(scans, {}, progress);
}

UpdateResult updated(const InterpretedMap& map, const ScanSet& before, const ScanSet& now) {
  NoProgress progress;
  return update(map.world, map.semantics, before, now, {}, progress);
}

const MapChange* find(const UpdateResult& result, MapChange::Kind kind, const std::string& name) {
  for (const MapChange& change : result.changes)
    if (change.kind == kind && change.name == name) return &change;
  return nullptr;
}

/// The kitchen before, scanned and interpreted once.
class UpdateTest : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    Kitchen kitchen;
    kitchen.add_chair({3.0, 2.1});
    before_ = new ScanSet(kitchen.scans(1));
    map_ = new InterpretedMap(interpreted(*before_));
  }
  static void TearDownTestSuite() {
    delete before_;
    delete map_;
  }

  static ScanSet* before_;
  static InterpretedMap* map_;
};
ScanSet* UpdateTest::before_ = nullptr;
InterpretedMap* UpdateTest::map_ = nullptr;

TEST_F(UpdateTest, NothingChanged) {
  Kitchen kitchen;
  kitchen.add_chair({3.0, 2.1});
  const UpdateResult result = updated(*map_, *before_, kitchen.scans(2));
  EXPECT_TRUE(result.changes.empty()) << result.text();
  EXPECT_THAT(result.text(), testing::HasSubstr("nothing changed"));
  EXPECT_EQ(result.map.semantics.links.size(), map_->semantics.links.size());
  EXPECT_EQ(result.scans.scans.size(), 2 * before_->scans.size());
  EXPECT_EQ(result.scans.scans.back().name, "update1_scan_004");
}

TEST_F(UpdateTest, TableAndChairMovedAndADrawerIsOpen) {
  const Isometry3d table = planar_motion(0.1, 0.06, 8, {2, 0.62, 0});
  Kitchen kitchen;
  kitchen.move("table_1", table);
  kitchen.add_chair({1.2, 2.0});
  ScanSet now = kitchen.scans(2, {{"drawer_2_front_joint", 0.3}});
  const Isometry3d offset = planar_motion(0.2, -0.15, 5, {0, 0, 0});  // Another start of the robot.
  for (Scan& scan : now.scans) scan.map_from_scan = offset * scan.map_from_scan;
  const UpdateResult result = updated(*map_, *before_, now);

  const MapChange* moved = find(result, MapChange::Kind::moved, "table_1");
  ASSERT_NE(moved, nullptr) << result.text();
  const Vector3d corner(2.5, 0.9, 0);
  EXPECT_LT((moved->now_from_before * corner - table * corner).norm(), 0.02);
  EXPECT_NEAR(moved->turn_deg(), 8, 1);
  EXPECT_GT(moved->probability, 0.9);
  EXPECT_FALSE(moved->scans.empty());
  EXPECT_THAT(moved->text(), testing::HasSubstr("table_1 moved 0.12 m and turned 8°"));
  EXPECT_LT((result.map_from_new.inverse().translation() - offset.translation()).norm(), 0.02);

  const MapChange* chair = find(result, MapChange::Kind::moved, "chair_1");
  ASSERT_NE(chair, nullptr) << result.text();
  EXPECT_NEAR(chair->distance(), Vector2d(1.8, 0.1).norm(), 0.03);

  const MapChange* drawer = find(result, MapChange::Kind::opened, "drawer_2");
  ASSERT_NE(drawer, nullptr) << result.text();
  EXPECT_NEAR(drawer->joint_position, 0.3, 0.02);
  EXPECT_EQ(result.changes.size(), 3U) << result.text();

  // The new map has the table at its new place, under its name, and everything else as it was.
  const Json& old_outline = map_->semantics.links.at("table_1").geometry.at("outline");
  Vector2d then = Vector2d::Zero(), here = Vector2d::Zero();
  for (const Json& p : old_outline) then += Vector2d(p[0], p[1]) / static_cast<double>(old_outline.size());
  const Json& outline = result.map.semantics.links.at("table_1").geometry.at("outline");
  for (const Json& p : outline) here += Vector2d(p[0], p[1]) / static_cast<double>(outline.size());
  EXPECT_LT((here - (table * Vector3d(then.x(), then.y(), 0)).head<2>()).norm(), 0.03);
  EXPECT_TRUE(result.map.semantics.links.contains("drawer_2_front"));
  EXPECT_TRUE(result.map.semantics.extra.at("pieces").contains("chair_1"));
  EXPECT_THAT(change_plan_svg(result), testing::HasSubstr("table_1"));
}

TEST_F(UpdateTest, AChairIsPlacedMoreExactlyThanItsBoardsAreThick) {
  const Isometry3d start(Eigen::Translation3d(3.0, 2.1, 0));
  const Isometry3d motion = planar_motion(-1.7, 0.1, 20, start.translation());
  Kitchen kitchen;
  kitchen.add_chair(motion * start);
  const UpdateResult result = updated(*map_, *before_, kitchen.scans(2));
  const MapChange* chair = find(result, MapChange::Kind::moved, "chair_1");
  ASSERT_NE(chair, nullptr) << result.text();
  const Isometry3d error = motion.inverse() * chair->now_from_before;
  EXPECT_LT((error * start.translation() - start.translation()).norm(), 0.003);
  EXPECT_LT(Eigen::AngleAxisd(error.linear()).angle(), 0.5 * kDegree);
}

/// A crate that was moved, and the update from so many scans.
class MovedCrate {
 public:
  MovedCrate(double x, double y, double yaw_deg, size_t scans)
      : motion_(planar_motion(x, y, yaw_deg, start_.translation())) {
    Kitchen first, second;
    first.add_crate(start_);
    second.add_crate(motion_ * start_);
    const ScanSet before = first.scans(1);
    ScanSet now = second.scans(2);
    now.scans.resize(scans);
    result_ = updated(interpreted(before), before, now);
  }

  const UpdateResult& result() const { return result_; }
  bool found() const {
    return !result_.changes.empty() && result_.changes.front().kind == MapChange::Kind::moved;
  }
  double position_error() const { return (error() * start_.translation() - start_.translation()).norm(); }
  /// Half a turn of a box cannot be seen.
  double turn_error() const { return std::abs(std::remainder(rpy_from_rotation(error().linear()).z(), kPi)); }

 private:
  Isometry3d error() const { return motion_.inverse() * result_.changes.front().now_from_before; }

  Isometry3d start_ = Isometry3d(Eigen::Translation3d(3.0, 2.1, 0)), motion_;
  UpdateResult result_;
};

TEST(UpdateOfACrate, ALongSideIsNotTakenForAShortOne) {
  const MovedCrate crate(-1.8, 0.1, 20, 5);
  ASSERT_TRUE(crate.found()) << crate.result().text();
  EXPECT_LT(crate.position_error(), 0.015);
  EXPECT_LT(crate.turn_error(), 3 * kDegree);
}

TEST(UpdateOfACrate, ItsSidesDoNotContinueWhatStandsStill) {
  const MovedCrate crate(-1.8, 0.1, -40, 3);
  ASSERT_TRUE(crate.found()) << crate.result().text();
  EXPECT_LT(crate.position_error(), 0.02);
}

TEST_F(UpdateTest, ADoorThatHidesItsOwnInsideIsOpenAndNoNewFurniture) {
  // Seen from beside its edge, and from where the open leaf stands before the inside.
  ScanSet now = Kitchen().scans(5, {{"door_2_joint", kPi / 2}},
                                {{1.2, 1.4, kPi / 2}, {2.2, 1.6, -kPi / 2}, {2.8, 1.4, kPi / 3}});
  const UpdateResult result = updated(*map_, *before_, now);
  const MapChange* door = find(result, MapChange::Kind::opened, "door_2");
  ASSERT_NE(door, nullptr) << result.text();
  EXPECT_NEAR(door->joint_position, kPi / 2, 0.2);  // Seen near the hinge only.
  for (const MapChange& change : result.changes) {
    EXPECT_NE(change.kind, MapChange::Kind::came) << change.text();
    EXPECT_NE(change.kind, MapChange::Kind::seen_first) << change.text();
  }
}

TEST_F(UpdateTest, AChairIsGone) {
  const UpdateResult result = updated(*map_, *before_, Kitchen().scans(2));
  ASSERT_EQ(result.changes.size(), 1U) << result.text();
  EXPECT_EQ(result.changes.front().text(), "chair_1 is gone");
}

TEST_F(UpdateTest, AChairCame) {
  Kitchen kitchen;
  kitchen.add_chair({3.0, 2.1});
  kitchen.add_chair({1.2, 2.0});
  const UpdateResult result = updated(*map_, *before_, kitchen.scans(2));
  ASSERT_EQ(result.changes.size(), 1U) << result.text();
  EXPECT_EQ(result.changes.front().text(), "chair_2 is new: its place was free before");
}

TEST_F(UpdateTest, ScansThatDoNotFitAreRefused) {
  ScanSet now = *before_;
  for (Scan& scan : now.scans)
    for (ScanPoint& point : scan.points) point.position *= 1.6F;  // A larger room.
  EXPECT_THROW(updated(*map_, *before_, now), Error);
  ScanSet blind = *before_;
  blind.free_space = false;
  EXPECT_THROW(updated(*map_, *before_, blind), Error);
  EXPECT_THROW(updated(*map_, *before_, ScanSet{}), Error);
}

/// The scans in another frame with z up.
ScanSet elsewhere(ScanSet scans, const Isometry3d& frame_from_map) {
  for (Scan& scan : scans.scans) scan.map_from_scan = frame_from_map * scan.map_from_scan;
  return scans;
}

TEST_F(UpdateTest, ScansOfAnUnknownFrameArePlacedInTheMap) {
  ScanSet now = Kitchen().scans(7);
  now.scans.erase(now.scans.begin() + 1, now.scans.begin() + 3);
  NoProgress progress;
  for (const double away : {1.0, 20.0}) {  // The origin of their frame may be far from the room.
    Isometry3d frame_from_map = planar_motion(1.3 * away, -2.1 * away, 137, Vector3d::Zero());
    frame_from_map.translation().z() = -1.42;
    const Placement placement = place_scans(*before_, elsewhere(now, frame_from_map), 2, progress);
    EXPECT_TRUE(placement.trusted) << placement.reason;
    const Isometry3d error = placement.map_from_scans * frame_from_map;
    EXPECT_LT(error.translation().norm(), 0.01);
    EXPECT_LT(Eigen::AngleAxisd(error.linear()).angle(), 0.2 * kDegree);
  }
}

TEST_F(UpdateTest, ScansOfAnotherRoomAreRefused) {
  ScanSet now = Kitchen().scans(8);
  for (Scan& scan : now.scans)  // A room of other proportions.
    for (ScanPoint& point : scan.points) point.position.head<2>() *= 1.35F;
  NoProgress progress;
  const Placement placement = place_scans(*before_, now, 2, progress);
  EXPECT_FALSE(placement.trusted);
  EXPECT_THAT(placement.reason, testing::HasSubstr("of the"));
}

TEST(ScansOfAMap, AreMovedByWhatLevelledTheMap) {
  const fs::path folder = fs::path(testing::TempDir()) / fmt::format("loci_scans_of_map_{}", getpid());
  ScanSet set;
  set.sensor = "kinect";
  set.levelled = false;
  set.scans.emplace_back();
  set.scans[0].name = "scan_000";
  set.scans[0].origins = {Eigen::Vector3f::Zero()};
  set.scans[0].points.emplace_back();
  write_scan_set(set, folder);
  SemanticMap map;
  Warnings warnings;
  EXPECT_FALSE(read_scans_of_map(folder, map, warnings).levelled);
  map.map_from_input = Isometry3d(Eigen::Translation3d(0, 0, -5));
  const ScanSet moved = read_scans_of_map(folder, map, warnings);
  EXPECT_TRUE(moved.levelled);
  EXPECT_NEAR(moved.scans[0].map_from_scan.translation().z(), -5, 1e-9);
  set.levelled = true;
  write_scan_set(set, folder);
  EXPECT_NEAR(read_scans_of_map(folder, map, warnings).scans[0].map_from_scan.translation().z(), 0, 1e-9);
  fs::remove_all(folder);
}

}  // namespace
}  // namespace loci::mapping
