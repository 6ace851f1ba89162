#include "mapping/exchange/comparison/compare_furniture.h"
#include "mapping/base/files.h"
#include "mapping/base/math/math.h"

#include <gmock/gmock.h>

#include <filesystem>

#include "mapping/exchange/furniture_structure.h"
#include "mapping/world/urdf.h"

namespace loci::mapping {
namespace {

KnownFront front(const std::string& name, double x, double z, double width = 0.6, double height = 0.3) {
  KnownFront known;
  known.name = known.front.name = name;
  known.front.normal = Vector3d(0, -1, 0);
  known.front.centre = Vector3d(x, 2, z);
  known.front.width = width;
  known.front.height = height;
  return known;
}

KnownFixture handle(const std::string& name, const std::string& of, const Vector3d& centre) {
  KnownFixture known;
  known.name = name;
  known.front = of;
  known.fixture.centre = centre;
  known.fixture.axis = Vector3d::UnitX();
  return known;
}

JointEstimate joint(ArticulationType type, const Vector3d& axis, const Vector3d& origin = Vector3d::Zero()) {
  JointEstimate estimate;
  estimate.type = type;
  estimate.axis = axis;
  estimate.origin = origin;
  estimate.upper = 1;
  return estimate;
}

const ComparedElement& thing_of(const Comparison& result, const std::string& truth_name) {
  return *std::ranges::find(result.elements, truth_name, &ComparedElement::truth_name);
}

TEST(CompareFurniture, OverlapOfRectanglesIsWhatGeometrySays) {
  const Front a = front("a", 0, 1).front;
  EXPECT_NEAR(overlap_of(a, a), 1, 1e-6);
  EXPECT_NEAR(overlap_of(front("b", 0.3, 1).front, a), 1.0 / 3, 1e-6);
  EXPECT_NEAR(overlap_of(front("b", 0, 1, 0.3, 0.3).front, a), 0.5, 1e-6);
  EXPECT_EQ(overlap_of(front("b", 1, 1).front, a), 0);
  Front behind = a;
  behind.centre.y() += 0.3;
  EXPECT_EQ(overlap_of(behind, a), 0);
  Front turned = a;
  turned.normal = Vector3d::UnitX();
  EXPECT_EQ(overlap_of(turned, a), 0);
}

TEST(CompareFurniture, HandlesMatchTheNearestOnceAndTheRestIsMissedOrInvented) {
  MapStructure truth, map;
  truth.fixtures = {handle("left", "", {0, 2, 1}), handle("right", "", {0.08, 2, 1}),
                    handle("far", "", {3, 2, 1})};
  map.fixtures = {handle("a", "", {0.07, 2, 1}), handle("b", "", {0.004, 2, 1.003}),
                  handle("c", "", {5, 2, 1})};
  const Comparison result = compare(map, truth, {});
  EXPECT_EQ(thing_of(result, "left").map_name, "b");
  EXPECT_NEAR(*thing_of(result, "left").centre_error, 0.005, 1e-9);
  EXPECT_EQ(thing_of(result, "right").map_name, "a");
  EXPECT_EQ(thing_of(result, "far").verdict, "missed");
  const Comparison::Counts counts = result.counts("handle");
  EXPECT_EQ(counts.matched, 2U);
  EXPECT_EQ(counts.missed, 1U);
  EXPECT_EQ(counts.extra, 1U);
}

TEST(CompareFurniture, WhatCannotBeSeenOrIsElsewhereIsNotAskedForAndNotInvented) {
  MapStructure truth, map;
  truth.fixtures = {handle("hidden", "", {0, 2, 1}), handle("bath", "", {9, 2, 1})};
  truth.fixtures[0].region = "kitchen";
  truth.fixtures[0].main = false;
  truth.fixtures[1].region = "other";
  truth.regions["kitchen"] = {Vector3d(0, 0, 0), Vector3d(4, 4, 2)};
  ComparisonOptions options;
  options.region = "kitchen";
  EXPECT_EQ(compare(map, truth, options).counts("handle").missed, 0U);
  map.fixtures = {handle("a", "", {0, 2, 1}), handle("b", "", {9, 2, 1}), handle("c", "", {7, 2, 1}),
                  handle("d", "", {2, 2, 1})};
  const Comparison::Counts counts = compare(map, truth, options).counts("handle");
  EXPECT_EQ(counts.minor, 3U);
  EXPECT_EQ(counts.extra, 1U);  // d: in the kitchen, and nothing is there
}

TEST(CompareFurniture, FrontsMatchByTheirHandlesBeforeTheirOverlap) {
  MapStructure truth, map;
  truth.fronts = {front("upper", 0, 1.0, 0.6, 0.2), front("lower", 0, 0.7, 0.6, 0.4)};
  truth.fixtures = {handle("upper_handle", "upper", {0, 1.97, 1.0}),
                    handle("lower_handle", "lower", {0, 1.97, 0.85})};
  // The upper front was not cut off from the lower one, and swallows it.
  map.fronts = {front("drawer_1", 0, 0.8, 0.6, 0.6)};
  map.fixtures = {handle("drawer_1_handle", "drawer_1", {0, 1.97, 1.0})};
  const Comparison result = compare(map, truth, {});
  EXPECT_EQ(thing_of(result, "upper").map_name, "drawer_1");
  EXPECT_NEAR(*thing_of(result, "upper").overlap, 1.0 / 3, 1e-6);
  EXPECT_EQ(thing_of(result, "lower").verdict, "missed");
}

TEST(CompareFurniture, JointErrorsAreThoseOfGeometry) {
  const double tilt = 2 * kPi / 180;
  const Vector3d centre(0, 2, 1);
  const JointEstimate drawer = joint(ArticulationType::prismatic, {0, -1, 0});
  const ComparedJoint slid = compare_joints(
      joint(ArticulationType::prismatic, {std::sin(tilt), -std::cos(tilt), 0}), drawer, centre);
  EXPECT_TRUE(slid.right());
  EXPECT_NEAR(*slid.axis_error_deg, 2, 1e-9);
  EXPECT_FALSE(slid.hinge_error);

  const JointEstimate door = joint(ArticulationType::revolute, {0, 0, 1}, {0.3, 2, 0});
  const ComparedJoint hung =
      compare_joints(joint(ArticulationType::revolute, {0, 0, 1}, {0.32, 2, 5}), door, centre);
  EXPECT_NEAR(*hung.axis_error_deg, 0, 1e-9);
  EXPECT_NEAR(*hung.hinge_error, 0.02, 1e-9);
  EXPECT_FALSE(hung.other_way);
  const ComparedJoint wrong =
      compare_joints(joint(ArticulationType::revolute, {0, 0, -1}, {0.3, 2, 0}), door, centre);
  EXPECT_NEAR(*wrong.axis_error_deg, 0, 1e-9);
  EXPECT_TRUE(wrong.other_way);

  EXPECT_FALSE(compare_joints(drawer, door, centre).right());
  EXPECT_FALSE(compare_joints(std::nullopt, door, centre).right());
}

TEST(CompareFurniture, JointThatOpensTowardsNegativeValuesIsTheSameAsItsMirror) {
  JointEstimate backwards = joint(ArticulationType::revolute, {0, 0, -1});
  backwards.lower = -1.5;
  backwards.upper = 0;
  EXPECT_FALSE(compare_joints(joint(ArticulationType::revolute, {0, 0, 1}), backwards, {0, 0, 0}).other_way);
}

TEST(CompareFurniture, SampleKitchenBySidecarEqualsItselfByGeometry) {
  const std::filesystem::path urdf = std::filesystem::path(LOCI_SOURCE_DIR) / "apps/samples/kitchen.urdf";
  Warnings warnings;
  const MeshSearch search{{}, urdf.parent_path()};
  const Comparison result = compare(read_structure(urdf, search, warnings),
                                    structure_from_geometry(read_urdf(urdf), search, warnings), {});
  for (const char* kind : {"front", "handle"}) {
    EXPECT_GE(result.counts(kind).matched, 3U) << result.text();
    EXPECT_EQ(result.counts(kind).missed, 0U) << result.text();
    EXPECT_EQ(result.counts(kind).extra, 0U) << result.text();
  }
  EXPECT_THAT(result.errors("front", &ComparedElement::overlap), testing::Each(testing::Gt(0.99)));
  EXPECT_THAT(result.errors("handle", &ComparedElement::centre_error), testing::Each(testing::Lt(0.002)));
  EXPECT_EQ(result.joints().rate(), 1);
}

TEST(CompareFurniture, TheFaceOfANarrowPullOutIsItsFrontNotItsSide) {
  // 15 cm wide, 50 cm deep, 70 cm high, with a bar in the middle.
  const World world = parse_urdf(R"(<robot name="r"><link name="map"/>
    <link name="pull_out">
      <visual><origin xyz="0.01 0 0"/><geometry><box size="0.02 0.15 0.7"/></geometry></visual>
      <visual><origin xyz="0.27 0.065 0"/><geometry><box size="0.5 0.016 0.7"/></geometry></visual>
      <visual><origin xyz="0.27 -0.065 0"/><geometry><box size="0.5 0.016 0.7"/></geometry></visual></link>
    <joint name="pull_out_joint" type="prismatic"><parent link="map"/><child link="pull_out"/>
      <origin xyz="2 0 0.5"/><axis xyz="-1 0 0"/><limit lower="0" upper="0.4" effort="1" velocity="1"/></joint>
    <link name="pull_out_handle"><visual><geometry><box size="0.012 0.012 0.2"/></geometry></visual></link>
    <joint name="handle_joint" type="fixed"><parent link="pull_out"/><child link="pull_out_handle"/>
      <origin xyz="-0.035 0 0"/></joint>
    <link name="panel"><visual><geometry><box size="0.02 0.8 0.7"/></geometry></visual></link>
    <joint name="panel_joint" type="prismatic"><parent link="map"/><child link="panel"/>
      <origin xyz="2 2 0.5"/><axis xyz="0 1 0"/><limit lower="0" upper="0.7" effort="1" velocity="1"/></joint>
    </robot>)",
                                 "pull_out.urdf");
  Warnings warnings;
  const MapStructure structure = structure_from_geometry(world, {}, warnings);
  ASSERT_EQ(structure.fronts.size(), 2U);
  const Front& front = structure.fronts[0].front;
  EXPECT_NEAR(front.normal.x(), -1, 1e-6);
  EXPECT_NEAR(front.width, 0.15, 1e-6);
  EXPECT_NEAR(structure.fronts[1].front.width, 0.8, 1e-6);  // What slides in its plane.
}

TEST(CompareFurniture, MeasuredFrontsJudgeTheirFacesOnly) {
  const std::filesystem::path file = std::filesystem::path(testing::TempDir()) / "measured_fronts.json";
  write_file_atomically(file, R"({"fronts": [{"name": "door", "centre": [2, 0, 0.5], "normal": [-1, 0, 0],
    "up": [0, 0, 1], "width": 0.6, "height": 0.7, "tolerance": 0.03,
    "handle": {"name": "bar", "centre": [1.97, 0, 0.8], "axis": [0, 1, 0], "length": 0.2}}]})");
  Warnings warnings;
  const MapStructure truth = read_structure(file, {}, warnings);
  MapStructure map = truth;
  map.fixtures[0].fixture.centre.z() += 0.07;  // within 5 cm and the tolerance of the truth
  KnownFront beside = map.fronts[0], elsewhere = map.fronts[0];
  beside.front.centre.y() += 0.5;
  elsewhere.front.centre.y() += 3;
  map.fronts.push_back(beside);
  map.fronts.push_back(elsewhere);
  ComparisonOptions options;
  options.handle_tolerance_m = 0.05;
  const Comparison result = compare(map, truth, options);
  EXPECT_EQ(result.counts("handle").matched, 1U);
  EXPECT_EQ(result.counts("front").matched, 1U);
  EXPECT_EQ(result.counts("front").extra, 1U);
  EXPECT_EQ(result.counts("front").minor, 1U);
}

TEST(CompareFurniture, ApartmentTruthSaysWhatIsAskedFor) {
  const std::filesystem::path folder = std::filesystem::path(LOCI_SHARED_DIR) / "data/iai_apartment";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no shared data";
  Warnings warnings;
  const MapStructure truth = read_structure(folder / "truth.json", {}, warnings);
  ComparisonOptions options;
  options.region = "kitchen";
  const Comparison nothing = compare({}, truth, options);
  EXPECT_EQ(nothing.counts("handle").missed, 24U);
  EXPECT_EQ(nothing.counts("front").missed, 27U);  // 18 drawers and 9 doors
}

TEST(CompareFurniture, ApartmentByGeometryIsNearItsTruth) {
  const std::filesystem::path folder = std::filesystem::path(LOCI_SHARED_DIR) / "data/iai_apartment";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no shared data";
  Warnings warnings;
  const MeshSearch search{{folder.parent_path()}, folder};
  ComparisonOptions options;
  options.region = "kitchen";
  const World world = read_urdf(folder / "apartment.urdf");
  MapStructure geometry;
  add_geometry_furniture(world, triangles_of(world, search, warnings), geometry);
  const Comparison result =
      compare(geometry, read_structure(folder / "truth.json", search, warnings), options);
  EXPECT_EQ(result.counts("handle").missed, 0U) << result.text();
  EXPECT_THAT(result.errors("handle", &ComparedElement::centre_error), testing::Each(testing::Lt(0.005)));
  EXPECT_EQ(result.counts("front").missed, 0U) << result.text();
  EXPECT_EQ(result.joints().rate(), 1) << result.text();
}

}  // namespace
}  // namespace loci::mapping
