#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>

#include "mapping/articulation/articulation.h"
#include "mapping/articulation/moved_face.h"
#include "mapping/base/files.h"
#include "mapping/base/math/math.h"
#include "mapping/base/math/random.h"
#include "mapping/base/text/json.h"
#include "mapping/simulation/simulated_robot.h"

namespace loci::mapping {
namespace {

namespace fs = std::filesystem;

constexpr double kFaceX = 3;  ///< faces look towards -x
constexpr double kPanel = 0.02;

/// A front of the test kitchen: a panel with a bar, and its joint.
struct Part {
  std::string name;
  double y, z, width, height;  ///< of the panel; +y is to the left of someone who looks at it
  double bar_y, bar_z;         ///< from the panel's centre
  bool upright;
  ArticulationType type;
  Vector3d axis;  ///< of opening
  Vector3d hinge = Vector3d::Zero();

  Vector3d centre() const { return {kFaceX, y, z}; }
};

Vector3d slide(double sideways_deg, double down_deg) {
  return Vector3d(-1, std::tan(sideways_deg * kDegree), -std::tan(down_deg * kDegree)).normalized();
}

const double kHinge = kFaceX + 0.5 * kPanel;

const std::vector<Part> kParts{
    {"askew", -1.2, 0.70, 0.6, 0.25, 0, 0.06, false, ArticulationType::prismatic, slide(4, 0)},
    {"sagging", -1.2, 0.44, 0.6, 0.25, 0, 0.06, false, ArticulationType::prismatic, slide(0, 3)},
    {"oven",
     -0.59,
     0.55,
     0.6,
     0.5,
     0,
     0.2,
     false,
     ArticulationType::revolute,
     Vector3d(0, -1, 0),
     {kHinge, 0, 0.30}},
    {"left",
     0.0,
     0.52,
     0.5,
     0.65,
     -0.2,
     0.1,
     true,
     ArticulationType::revolute,
     Vector3d(0, 0, -1),
     {kHinge, 0.25, 0}},
    {"right",
     0.51,
     0.52,
     0.5,
     0.65,
     0.2,
     0.1,
     true,
     ArticulationType::revolute,
     Vector3d(0, 0, 1),
     {kHinge, 0.26, 0}},
    {"lift",
     0.0,
     1.65,
     0.8,
     0.4,
     0,
     -0.16,
     false,
     ArticulationType::revolute,
     Vector3d(0, 1, 0),
     {kHinge, 0, 1.85}},
};

std::string box(const std::string& name, const Vector3d& at, const Vector3d& size) {
  return fmt::format(
      "<link name=\"{}\"><visual><origin xyz=\"{} {} {}\"/><geometry><box size=\"{} {} {}\"/></geometry>"
      "<material name=\"{}_paint\"><color rgba=\"0.6 0.6 0.55 1\"/></material></visual></link>\n",
      name, at.x(), at.y(), at.z(), size.x(), size.y(), size.z(), name);
}

std::string fixed(const std::string& parent, const std::string& child) {
  return fmt::format(
      "<joint name=\"{1}_fixed\" type=\"fixed\"><parent link=\"{0}\"/><child link=\"{1}\"/></joint>\n",
      parent, child);
}

/// Panels (with a body behind those that slide) before a row of carcasses.
std::string kitchen_urdf() {
  std::string text = "<robot name=\"row\"><link name=\"map\"/>\n";
  text += box("carcass", {kFaceX + 0.33, -0.4, 0.42}, {0.6, 2.4, 0.84}) + fixed("map", "carcass");
  text += box("cupboard", {kFaceX + 0.23, 0, 1.65}, {0.4, 0.8, 0.4}) + fixed("map", "cupboard");
  for (const Part& part : kParts) {
    const bool slides = part.type == ArticulationType::prismatic;
    const Vector3d pivot = slides ? part.centre()
                                  : Vector3d(part.hinge.x(), part.axis.y() != 0 ? part.y : part.hinge.y(),
                                             part.axis.z() != 0 ? part.z : part.hinge.z());
    const Vector3d face = part.centre() - pivot;
    text += box(part.name, face + Vector3d(0.5 * kPanel, 0, 0), {kPanel, part.width, part.height});
    text += fmt::format(
        "<joint name=\"{0}_joint\" type=\"{1}\"><parent link=\"map\"/><child link=\"{0}\"/>"
        "<origin xyz=\"{2} {3} {4}\"/><axis xyz=\"{5} {6} {7}\"/>"
        "<limit lower=\"0\" upper=\"{8}\" effort=\"1\" velocity=\"1\"/></joint>\n",
        part.name, slides ? "prismatic" : "revolute", pivot.x(), pivot.y(), pivot.z(), part.axis.x(),
        part.axis.y(), part.axis.z(), slides ? 0.45 : 1.57);
    const std::string bar = part.name + "_bar";
    text += box(bar, face + Vector3d(-0.035, part.bar_y, part.bar_z),
                {0.012, part.upright ? 0.012 : 0.2, part.upright ? 0.2 : 0.012});
    text += fixed(part.name, bar);
  }
  return text + "</robot>";
}

/// What interpretation makes of a part: some centimetres too small on one side, too wide on the other.
Front believed(const Part& part, double wrong = 0.03) {
  Front front;
  front.name = part.name;
  front.centre = part.centre() + Vector3d(0, wrong, 0);
  front.normal = -Vector3d::UnitX();
  front.width = part.width + 0.5 * wrong;
  front.height = part.height - wrong;
  front.fixture = Fixture{};
  front.fixture->centre = part.centre() + Vector3d(-0.035, part.bar_y, part.bar_z);
  front.fixture->axis = part.upright ? Vector3d::UnitZ() : Vector3d::UnitY();
  front.fixture->length = 0.2;
  return front;
}

double overlap(const Front& front, const Part& part) {
  const auto shared = [](double a, double a_size, double b, double b_size) {
    return std::max(0.0, std::min(a + a_size / 2, b + b_size / 2) - std::max(a - a_size / 2, b - b_size / 2));
  };
  const double both = shared(front.centre.y(), front.width, part.y, part.width) *
                      shared(front.centre.z(), front.height, part.z, part.height);
  return both / (front.width * front.height + part.width * part.height - both);
}

class MovedFronts : public testing::Test {
 protected:
  MovedFronts() : folder_(fs::temp_directory_path() / ("loci_row_" + std::to_string(getpid()))) {
    make_folder(folder_);
    write_file_atomically(folder_ / "row.urdf", kitchen_urdf());
  }
  ~MovedFronts() override { fs::remove_all(folder_); }

  SimulatedRobot robot(uint64_t seed) {
    SimulatedRobotOptions options;
    options.laser.tilt_step_deg = options.laser.azimuth_step_deg = 0.4;
    options.seed = seed;
    options.floor.reset();  // Fronts are judged by themselves.
    options.threads = 1;
    return {folder_ / "row.urdf", options, {1.5, 0, 0}, warnings_};
  }
  static ScanSet set_of(Scan scan) {
    ScanSet set;
    set.sensor = "hokuyo";
    set.scans = {std::move(scan)};
    return set;
  }
  static void expect_joint(const DifferenceResult& result, const Part& part) {
    ASSERT_TRUE(result.joint) << result.reason;
    EXPECT_EQ(result.joint->type, part.type);
    EXPECT_LT(std::acos(std::min(result.joint->axis.dot(part.axis), 1.0)) / kDegree, 1);
    if (part.type == ArticulationType::revolute) {
      const Vector3d off = result.joint->origin - part.hinge;
      EXPECT_LT((off - part.axis * part.axis.dot(off)).norm(), 0.02);
    }
    ASSERT_TRUE(result.corrected);
    EXPECT_GT(overlap(*result.corrected, part), 0.85);
    EXPECT_GT(result.joint->probabilities[static_cast<size_t>(part.type)], 0.9);
  }

  fs::path folder_;
  Warnings warnings_;
};

TEST_F(MovedFronts, ScansFitTheMapOfTheirKitchenAndNoOther) {
  const ScanSet scans = set_of(robot(1).scan_at({1.5, 0, 0}));
  std::vector<Front> own, other;
  for (const Part& part : kParts) {
    own.push_back(believed(part, 0));
    other.push_back(own.back());
    other.back().centre += Vector3d(-0.6, 0.4, 0.1);  // where the robot looked through
  }
  const MapFit fits = fit_to_map(scans, own, {});
  EXPECT_EQ(fits.there, own.size());
  EXPECT_TRUE(fits.plausible());
  EXPECT_FALSE(fit_to_map(scans, other, {}).plausible());
}

TEST_F(MovedFronts, PullingGivesTypeAxisHingeAndRectangle) {
  for (const uint64_t seed : {1, 2, 3}) {
    SimulatedRobot world = robot(seed);
    for (const Part& part : kParts) {
      SCOPED_TRACE(part.name + ", seed " + std::to_string(seed));
      world.put_at({1.5, part.y + 0.3, 0});
      const Scan closed = world.scan_at({1.5, part.y + 0.3, 0});
      const Front front = believed(part);
      const PullResult pulled = world.pull(front.fixture->centre, 0.3);
      EXPECT_EQ(pulled.joint, part.name + "_joint");
      const Scan open = world.scan_at({1.5, part.y + 0.3, 0});
      const DifferenceResult result = articulate(set_of(closed), set_of(open), front, pulled.hand_path, {});
      expect_joint(result, part);
      EXPECT_NEAR(result.moved, pulled.moved, part.type == ArticulationType::prismatic ? 0.01 : 0.05);
      EXPECT_LT(result.joint->axis_sd_deg, 1);
      if (part.type == ArticulationType::revolute) {
        EXPECT_LT(result.joint->origin_sd_m, 0.01);
      }
      EXPECT_EQ(result.joint->evidence, "interaction");
      world.close_all();
    }
  }
}

TEST_F(MovedFronts, TwoScanSetsFromDriftingPosesSuffice) {
  SimulatedRobot world = robot(4);
  for (const Part& part : kParts) {
    SCOPED_TRACE(part.name);
    world.put_at({1.5, part.y + 0.3, 0});
    const Scan closed = world.scan_at({1.5, part.y + 0.3, 0});
    const Front front = believed(part);
    const PullResult pulled = world.pull(front.fixture->centre, 0.3);
    // Registered to some millimetres after a drive, so that what stayed is not where it was either.
    Scan open = world.scan_at({1.4, part.y - 0.3, 10 * kDegree});
    open.map_from_scan = world.true_map_from_scanner();
    open.map_from_scan.pretranslate(Vector3d(0.004, -0.004, 0));
    open.map_from_scan.rotate(Eigen::AngleAxisd(0.1 * kDegree, Vector3d::UnitZ()));
    const DifferenceResult result = articulate(set_of(closed), set_of(open), front, {}, {});
    ASSERT_TRUE(result.joint) << result.reason;
    EXPECT_EQ(result.joint->type, part.type);
    EXPECT_EQ(result.joint->evidence, "difference");
    EXPECT_GT(result.joint->probabilities[static_cast<size_t>(part.type)], 0.8);
    // Two faces do not show to which side a drawer slides: the uncertainty says so.
    const double off = std::acos(std::min(result.joint->axis.dot(part.axis), 1.0)) / kDegree;
    EXPECT_LT(off, 2 * result.joint->axis_sd_deg);
    if (part.type == ArticulationType::revolute) {
      EXPECT_LT(off, 1);
    }
    EXPECT_GT(overlap(*result.corrected, part), 0.85);
    world.close_all();
  }
}

TEST_F(MovedFronts, HandInADriftedFrameStaysConsistentWithItsScans) {
  SimulatedRobot world = robot(5);
  const Part& part = kParts[4];
  const PlanarPose stop{1.5, part.y + 0.3, 0};
  world.put_at({0.5, 0, 0});
  Scan closed = world.scan_at(stop);  // About 3 cm off, and it does not know.
  const Isometry3d believed_from_true = closed.map_from_scan * world.true_map_from_scanner().inverse();
  Front front = believed(part);
  front.fixture->centre = believed_from_true * front.fixture->centre;
  front.centre = believed_from_true * front.centre;
  front.normal = believed_from_true.linear() * front.normal;
  const PullResult pulled = world.pull(front.fixture->centre, 0.3);
  ASSERT_EQ(pulled.joint, part.name + "_joint");
  const Scan open = world.scan_at(stop);
  DifferenceResult result = articulate(set_of(closed), set_of(open), front, pulled.hand_path, {});
  ASSERT_TRUE(result.joint && result.corrected);
  const Isometry3d true_from_believed = believed_from_true.inverse();
  result.joint->axis = true_from_believed.linear() * result.joint->axis;
  result.joint->origin = true_from_believed * result.joint->origin;
  result.corrected->centre = true_from_believed * result.corrected->centre;
  expect_joint(result, part);
}

TEST_F(MovedFronts, UncertaintiesAreAsLargeAsErrors) {
  double axis = 0, hinge = 0;
  int count = 0;
  for (uint64_t seed = 10; seed < 22; ++seed) {
    SimulatedRobot world = robot(seed);
    const Part& part = kParts[3 + seed % 2];
    world.put_at({1.5, part.y + 0.3, 0});
    const Scan closed = world.scan_at({1.5, part.y + 0.3, 0});
    const Front front = believed(part);
    const PullResult pulled = world.pull(front.fixture->centre, 0.3);
    const Scan open = world.scan_at({1.5, part.y + 0.3, 0});
    const DifferenceResult result = articulate(set_of(closed), set_of(open), front, pulled.hand_path, {});
    ASSERT_TRUE(result.joint);
    const double off = std::acos(std::min(result.joint->axis.dot(part.axis), 1.0)) / kDegree;
    const Vector3d aside = result.joint->origin - part.hinge;
    axis += std::pow(off / result.joint->axis_sd_deg, 2);
    hinge +=
        (aside - part.axis * part.axis.dot(aside)).squaredNorm() / std::pow(result.joint->origin_sd_m, 2);
    ++count;
  }
  EXPECT_LT(std::sqrt(axis / count), 2);
  EXPECT_GT(std::sqrt(axis / count), 0.3);
  EXPECT_LT(std::sqrt(hinge / count), 2);
  EXPECT_GT(std::sqrt(hinge / count), 0.3);
}

TEST_F(MovedFronts, NothingMovedIsNoJoint) {
  SimulatedRobot world = robot(6);
  world.put_at({1.5, 0, 0});
  const Scan closed = world.scan_at({1.5, 0, 0}), again = world.scan_at({1.5, 0, 0});
  for (const Part& part : kParts) {
    const DifferenceResult result = articulate(set_of(closed), set_of(again), believed(part), {}, {});
    EXPECT_FALSE(result.joint) << part.name;
    EXPECT_FALSE(result.reason.empty());
  }
}

TEST_F(MovedFronts, NeighbourThatMovedIsNotTakenForTheFront) {
  SimulatedRobot world = robot(7);
  world.put_at({1.5, 0, 0});
  const Scan closed = world.scan_at({1.5, 0, 0});
  world.set_joints({{"right_joint", 0.6}});
  const Scan open = world.scan_at({1.5, 0, 0});
  const DifferenceResult left = articulate(set_of(closed), set_of(open), believed(kParts[3]), {}, {});
  EXPECT_FALSE(left.joint) << left.report().dump();
  EXPECT_TRUE(articulate(set_of(closed), set_of(open), believed(kParts[4]), {}, {}).joint);
}

/// A hand that was led about an upright hinge at `hinge` by 0.3 m, from the handle of a front 0.5 m wide.
std::vector<Isometry3d> led_about(const Vector3d& hinge, const Vector3d& handle) {
  std::vector<Isometry3d> path;
  const double radius = (handle - hinge).head<2>().norm();
  Random noise(1);
  for (int i = 0; i <= 30; ++i) {
    const Eigen::AngleAxisd turn(-0.01 * i / radius, Vector3d::UnitZ());
    Isometry3d pose = Isometry3d::Identity();
    pose.linear() = turn.toRotationMatrix();
    pose.translation() = hinge + turn * (handle - hinge);
    for (int k = 0; k < 3; ++k) pose.translation()[k] += 0.001 * noise.normal();
    path.push_back(pose);
  }
  return path;
}

TEST_F(MovedFronts, TheHandShowsTheJointOfAFrontOfWhichAnotherPartStayed) {
  SimulatedRobot world = robot(8);
  world.put_at({1.5, 0, 0});
  const Scan closed = world.scan_at({1.5, 0, 0});
  const Part& left = kParts[3];
  Front both = believed(left, 0);  // Two doors, taken for one.
  both.centre.y() = 0.26;
  both.width = 1.01;
  const DifferenceResult result =
      articulate(set_of(closed), set_of(closed), both, led_about(left.hinge, both.fixture->centre), {});
  ASSERT_TRUE(result.joint) << result.reason;
  EXPECT_EQ(result.joint->type, ArticulationType::revolute);
  EXPECT_LT((result.joint->origin - left.hinge).head<2>().norm(), 0.02);
  EXPECT_THAT(result.reason, testing::HasSubstr("the joint is from the path of the hand"));
}

/// Points of a door 3 cm thick, hinged at its left edge and opened by `angle`: its broad side, and, seen from
/// above and ten times as densely, its upper edge.
std::vector<Vector3d> thick_door(double angle, double width, double height) {
  std::vector<Vector3d> points;
  const Eigen::AngleAxisd turn(-angle, Vector3d::UnitZ());
  const auto add = [&](double out, double y, double z) {
    points.push_back(Vector3d(kFaceX, width / 2, 0) + turn * Vector3d(out, y - width, z));
  };
  for (double y = 0.01; y < width; y += 0.02) {
    for (double z = 0.11; z < height; z += 0.02) add(0, y, z);
    for (int i = 0; i < 15; ++i) add(0.002 * i, y, height);
  }
  return points;
}

TEST(MovedFaces, UpperEdgeOfAThickDoorDoesNotTiltItsHinge) {
  const double width = 0.6, height = 0.5;
  Front front;
  front.centre = Vector3d(kFaceX, 0, height / 2);
  front.normal = -Vector3d::UnitX();
  front.width = width;
  front.height = height;
  const FittedPlane closed{front.normal, -kFaceX, 0.001, 500};
  const auto found = moved_faces(closed, thick_door(30 * kDegree, width, height), front, 0.03);
  const auto& turned = found[static_cast<size_t>(ArticulationType::revolute)];
  ASSERT_TRUE(turned);
  EXPECT_LT(std::acos(std::abs(turned->motion.axis.z())) / kDegree, 0.3) << turned->motion.axis.transpose();
  EXPECT_NEAR(turned->motion.position, 30 * kDegree, kDegree);
}

TEST(Articulation, HingeFarOutsideAFrontIsNotItsHinge) {
  const Part& part = kParts[3];
  const Front front = believed(part, 0);
  const Vector3d handle = front.fixture->centre;
  const DifferenceResult own = articulate({}, {}, front, led_about(part.hinge, handle), {});
  ASSERT_TRUE(own.joint) << own.reason;
  EXPECT_EQ(own.joint->type, ArticulationType::revolute);
  EXPECT_FALSE(own.unexplained_motion);
  const Vector3d far = part.hinge + Vector3d(0, 1, 0);  // Twice its width beside it.
  const DifferenceResult other = articulate({}, {}, front, led_about(far, handle), {});
  EXPECT_FALSE(other.joint) << other.report().dump();
  EXPECT_TRUE(other.unexplained_motion);
  EXPECT_FALSE(other.reason.empty());
}

TEST(ClosedFace, ACounterAboveALowDrawerDoesNotTiltIt) {
  Front front;
  front.centre = Vector3d(3, 0, 0.73);
  front.normal = -Vector3d::UnitX();
  front.up = Vector3d::UnitZ();
  front.width = 0.8;
  front.height = 0.18;  // 1 cm too high
  std::vector<Vector3d> points;
  for (double y = -0.4; y <= 0.4; y += 0.01) {
    for (double z = 0.64; z < 0.81; z += 0.01) points.emplace_back(3, y, z);
    for (double x = 3; x < 3.04; x += 0.001) points.emplace_back(x, y, 0.81);  // the counter's top
  }
  const FittedPlane face = closed_face(points, front);
  EXPECT_LT(std::acos(std::min(1.0, face.normal.dot(front.normal))) / kDegree, 0.1);
}

}  // namespace
}  // namespace loci::mapping
