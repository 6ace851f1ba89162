#include "mapping/interpretation/interpretation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "mapping/base/text/json.h"
#include "mapping/world/urdf.h"
#include "tests/mapping/interpretation/synthetic_room.h"

namespace loci::mapping::test {
namespace {

InterpretedMap interpreted(const ScanSet& scans, int threads = 0) {
  InterpretationOptions options;
  options.threads = threads;
  NoProgress progress;
  return interpret(scans, options, progress);
}

struct Box2 {
  Vector2d low = Vector2d::Constant(1e9), high = Vector2d::Constant(-1e9);
};

Box2 outline_box(const InterpretedMap& map, const std::string& name) {
  Box2 box;
  for (const Json& corner : map.semantics.links.at(name).geometry.at("outline")) {
    const Vector2d at(corner.at(0).get<double>(), corner.at(1).get<double>());
    box = {box.low.cwiseMin(at), box.high.cwiseMax(at)};
  }
  return box;
}

void expect_box(const Box2& box, const Vector2d& low, const Vector2d& high, double tolerance) {
  EXPECT_LT((box.low - low).cwiseAbs().maxCoeff(), tolerance)
      << box.low.transpose() << " / " << low.transpose();
  EXPECT_LT((box.high - high).cwiseAbs().maxCoeff(), tolerance)
      << box.high.transpose() << " / " << high.transpose();
}

double height_of(const InterpretedMap& map, const std::string& name) {
  return map.semantics.links.at(name).geometry.at("height").get<double>();
}

std::vector<std::string> names_of(const InterpretedMap& map) {
  std::vector<std::string> names;
  for (const auto& [name, link] : map.semantics.links) names.push_back(name);
  return names;
}

TEST(Interpretation, FindsFloorWallsTableAndCounterOfANoisyRoom) {
  const InterpretedMap map = interpreted(scan_room(kitchen(), kOrigins, 0.002, 1));
  EXPECT_THAT(names_of(map),
              testing::UnorderedElementsAre("ceiling", "counter_1", "floor", "table_1", "table_1_legs",
                                            "wall_east", "wall_north", "wall_south", "wall_west"));
  EXPECT_NEAR(height_of(map, "floor"), 0, 0.005);
  EXPECT_NEAR(height_of(map, "table_1"), 0.74, 0.005);
  EXPECT_NEAR(height_of(map, "counter_1"), 0.90, 0.005);
  expect_box(outline_box(map, "table_1"), {1.4, 0.5}, {2.6, 1.3}, 0.03);
  expect_box(outline_box(map, "counter_1"), {0.5, 2.4}, {2.9, 3.0}, 0.03);
  const Json& north = map.semantics.links.at("wall_north").geometry;
  EXPECT_NEAR(north.at("normal").at(1).get<double>(), -1, 1e-3);  // into the room
  EXPECT_NEAR(north.at("offset").get<double>(), -3, 0.01);
}

/// The largest distance from a corner of a rectangle, turned about its middle, to the nearest of an outline.
double corner_error(const InterpretedMap& map, const std::string& name, const Vector2d& middle,
                    const Vector2d& size, double yaw) {
  double worst = 0;
  for (const double x : {-0.5, 0.5})
    for (const double y : {-0.5, 0.5}) {
      const Vector2d corner = middle + Eigen::Rotation2Dd(yaw) * Vector2d(x * size.x(), y * size.y());
      double nearest = 1e9;
      for (const Json& at : map.semantics.links.at(name).geometry.at("outline"))
        nearest =
            std::min(nearest, (Vector2d(at.at(0).get<double>(), at.at(1).get<double>()) - corner).norm());
      worst = std::max(worst, nearest);
    }
  return worst;
}

TEST(Interpretation, ATableStandsAtAnyAngleToTheWalls) {
  for (const double yaw_deg : {5.0, 25.0, 60.0}) {
    AnalyticRoom room;
    room.solids.push_back({{1.4, 1.1, 0.71}, {2.6, 1.9, 0.74}, yaw_deg * kDegree});
    const InterpretedMap map = interpreted(scan_room(room, kOrigins, 0.002, 1));
    EXPECT_EQ(map.semantics.links.at("table_1").geometry.at("outline").size(), 4) << yaw_deg;
    EXPECT_LT(corner_error(map, "table_1", {2, 1.5}, {1.2, 0.8}, yaw_deg * kDegree), 0.02) << yaw_deg;
  }
}

TEST(Interpretation, SupportsOfATurnedRoomLieAlongItsWalls) {
  const double yaw = 30.2 * kDegree;  // Between two bins of the search for the room's direction.
  ScanSet scans = scan_room(kitchen(), kOrigins, 0.002, 1);
  const Isometry3d turn(Eigen::AngleAxisd(yaw, Vector3d::UnitZ()));
  for (Scan& scan : scans.scans) scan.map_from_scan = turn * scan.map_from_scan;
  const InterpretedMap map = interpreted(scans);
  const Json& outline = map.semantics.links.at("counter_1").geometry.at("outline");
  for (size_t i = 0; i < outline.size(); ++i) {
    const Json &from = outline.at(i), &to = outline.at((i + 1) % outline.size());
    const double direction = std::atan2(to.at(1).get<double>() - from.at(1).get<double>(),
                                        to.at(0).get<double>() - from.at(0).get<double>());
    EXPECT_NEAR(std::remainder(direction - yaw, kPi / 2) / kDegree, 0, 0.05);
  }
}

TEST(Interpretation, ATableHasTheLegsThatWereSeenButNotThoseOfChairs) {
  AnalyticRoom room = kitchen();
  for (const double x : {1.75, 2.05}) room.solids.push_back({{x, 0.9, 0}, {x + 0.04, 0.94, 0.45}});
  room.solids.push_back({{1.75, 0.9, 0.45}, {2.09, 1.2, 0.48}});  // a seat below the table
  const InterpretedMap map = interpreted(scan_room(room, kOrigins, 0.002, 1));
  const Json& footprints = map.semantics.links.at("table_1_legs").geometry.at("footprints");
  ASSERT_EQ(footprints.size(), 4U);
  for (const Json& footprint : footprints) {
    Vector2d centre = Vector2d::Zero();
    for (const Json& corner : footprint)
      centre += Vector2d(corner.at(0).get<double>(), corner.at(1).get<double>()) / 4;
    // The legs stand 5.5 cm inside of the corners of the top.
    EXPECT_NEAR(std::abs(centre.x() - 2.0), 0.545, 0.02);
    EXPECT_NEAR(std::abs(centre.y() - 0.9), 0.345, 0.02);
  }
  EXPECT_EQ(map.world.parent_joint("table_1_legs")->parent, "table_1");
  const Link* legs = map.world.find_link("table_1_legs");
  EXPECT_EQ(legs->collisions.size(), 4U);
  for (const Collision& leg : legs->collisions) {
    const double half = std::get<Box>(leg.geometry).size.z() / 2;
    const double middle = 0.74 + leg.link_from_collision.translation().z();
    EXPECT_NEAR(middle - half, 0, 0.01);
    EXPECT_NEAR(middle + half, 0.70, 0.01);  // below the slab of 4 cm
  }
}

TEST(Interpretation, EveryLinkHasEvidenceGeometryCollisionAndInertia) {
  const InterpretedMap map = interpreted(scan_room(kitchen(), kOrigins, 0.002, 2));
  for (const auto& [name, semantics] : map.semantics.links) {
    EXPECT_GT(semantics.evidence.at("inliers").get<size_t>(), 0U) << name;
    EXPECT_FALSE(semantics.evidence.at("scans").empty()) << name;
    EXPECT_GT(semantics.confidence, 0) << name;
    EXPECT_LE(semantics.confidence, 1) << name;
    const Link* link = map.world.find_link(name);
    ASSERT_NE(link, nullptr) << name;
    EXPECT_FALSE(link->visuals.empty());
    EXPECT_FALSE(link->collisions.empty());
    ASSERT_TRUE(link->inertial.has_value());
    EXPECT_GT(link->inertial->mass, 0);
    EXPECT_NE(map.world.find_joint(name + "_joint"), nullptr);
  }
  const World again = parse_urdf(urdf_text(map.world), "map.urdf");
  EXPECT_EQ(again.links.size(), map.world.links.size());
}

TEST(Interpretation, SupportFrameStandsAtTheCentreOfItsTopWithXAwayFromTheWall) {
  const InterpretedMap map = interpreted(scan_room(kitchen(), kOrigins, 0.002, 3));
  const Joint* joint = map.world.find_joint("counter_1_joint");
  ASSERT_NE(joint, nullptr);
  const Vector3d origin = joint->parent_from_joint.translation();
  EXPECT_NEAR(origin.x(), 1.7, 0.03);
  EXPECT_NEAR(origin.y(), 2.7, 0.03);
  EXPECT_NEAR(origin.z(), 0.9, 0.005);
  EXPECT_NEAR(joint->parent_from_joint.linear()(1, 0), -1, 0.01);  // x looks to -y
}

TEST(Interpretation, SaysWhyASupportHasItsClass) {
  const InterpretedMap map = interpreted(scan_room(kitchen(), kOrigins, 0.002, 4));
  EXPECT_THAT(map.semantics.links.at("table_1").evidence.at("class_because").get<std::string>(),
              testing::HasSubstr("free space seen under"));
  EXPECT_THAT(map.semantics.links.at("counter_1").evidence.at("class_because").get<std::string>(),
              testing::HasSubstr("from a wall"));
}

TEST(Interpretation, SameKitchenScannedFromElsewhereGetsTheSameNames) {
  AnalyticRoom room = kitchen();
  room.solids.push_back({{3.4, 0.4, 0}, {4.0, 1.4, 0.9}});  // a second counter, at the east wall
  const InterpretedMap first = interpreted(scan_room(room, kOrigins, 0.002, 5));
  const InterpretedMap second =
      interpreted(scan_room(room, {{1.0, 1.7, 1.6}, {3.1, 2.0, 1.4}, {2.9, 1.6, 1.5}}, 0.002, 6));
  EXPECT_EQ(names_of(first), names_of(second));
  for (const char* name : {"counter_1", "counter_2"}) {
    const Box2 a = outline_box(first, name);
    const Box2 b = outline_box(second, name);
    EXPECT_LT((a.low - b.low).norm() + (a.high - b.high).norm(), 0.15) << name;
  }
}

TEST(Interpretation, PartialViewGivesNothingThatWasNotSeen) {
  // One look from the south: the walls behind the sensor and the far end are not seen.
  ScanSet scans = scan_room(kitchen(), {{2.0, 0.2, 1.5}}, 0.002, 7);
  std::erase_if(scans.scans[0].points, [](const ScanPoint& point) { return point.position.y() < 0.3F; });
  const InterpretedMap map = interpreted(scans);
  EXPECT_FALSE(map.semantics.links.contains("wall_south"));
  EXPECT_TRUE(map.semantics.links.contains("wall_north"));
  EXPECT_TRUE(map.semantics.links.contains("counter_1"));
}

TEST(Interpretation, LevelsATiltedInputByItsFloorAndSaysHow) {
  ScanSet scans = scan_room(kitchen(), kOrigins, 0.002, 8);
  Isometry3d tilted = Isometry3d::Identity();
  tilted.linear() = (Eigen::AngleAxisd(0.2, Vector3d::UnitX()) * Eigen::AngleAxisd(-0.1, Vector3d::UnitY()))
                        .toRotationMatrix();
  tilted.translation().z() = -1.3;
  for (Scan& scan : scans.scans) scan.map_from_scan = tilted * scan.map_from_scan;
  scans.levelled = false;
  const InterpretedMap map = interpreted(scans);
  ASSERT_TRUE(map.semantics.map_from_input.has_value());
  const Vector3d up = *map.semantics.map_from_input * (tilted * Vector3d(0, 0, 1));
  EXPECT_NEAR(up.z(), 1, 0.01);
  EXPECT_NEAR(height_of(map, "table_1"), 0.74, 0.01);
}

/// Views of a table from 0.6 m over it in the frame of the first camera, as of a recording whose floor is not
/// known; `keep` decides by position in the room what is in view.
template <typename Keep>
ScanSet views_of_a_table(const Keep& keep) {
  ScanSet scans = scan_room(kitchen(), {{1.7, 0.9, 1.34}, {2.2, 0.9, 1.34}}, 0.002, 31);
  scans.sensor = kDepthCameraSensor;
  scans.levelled = false;
  for (Scan& scan : scans.scans) {
    std::erase_if(scan.points, [&](const ScanPoint& point) {
      return !point.returned || !keep(Vector3d(scan.map_from_scan * point.position.cast<double>()));
    });
    scan.map_from_scan = Eigen::Translation3d(-1.7, -0.9, -1.34) * scan.map_from_scan;
  }
  return scans;
}

TEST(Interpretation, TableTopThatFillsTheViewIsATableAtAnAssumedHeight) {
  const InterpretedMap map = interpreted(views_of_a_table([](const Vector3d& at) {
    return at.z() > 0.7 && at.z() < 1 && at.x() > 1.42 && at.x() < 2.58 && at.y() > 0.52 && at.y() < 1.28;
  }));
  EXPECT_FALSE(map.semantics.links.contains("floor"));
  ASSERT_TRUE(map.semantics.links.contains("table_1")) << map.summary();
  EXPECT_NEAR(height_of(map, "table_1"), InterpretationOptions().table_height_m, 0.01);
  EXPECT_THAT(map.notes, testing::Contains(testing::HasSubstr("its height over the floor is not known")));
}

TEST(Interpretation, TableWhoseFloorIsSeenBeyondItsEdgesStandsOnThat) {
  const InterpretedMap map = interpreted(views_of_a_table(
      [](const Vector3d& at) { return at.x() > 1.1 && at.x() < 2.8 && at.y() > 0.4 && at.y() < 1.7; }));
  ASSERT_TRUE(map.semantics.links.contains("table_1")) << map.summary();
  EXPECT_NEAR(height_of(map, "table_1"), 0.74, 0.015);
}

TEST(Interpretation, TableAmongClutterIsNoFloorAlthoughNoneIsSeen) {
  // Beyond the edges nothing level is seen, only legs and what stands there.
  const InterpretedMap map = interpreted(views_of_a_table([](const Vector3d& at) {
    return at.x() > 1.1 && at.x() < 2.9 && at.y() > 0.4 && at.y() < 3.1 && (at.z() > 0.1 && at.z() < 0.89);
  }));
  EXPECT_FALSE(map.semantics.links.contains("floor")) << map.summary();
  ASSERT_TRUE(map.semantics.links.contains("table_1")) << map.summary();
  EXPECT_NEAR(height_of(map, "table_1"), InterpretationOptions().table_height_m, 0.01);
  EXPECT_THAT(map.notes, testing::Contains(testing::HasSubstr("goes down below it")));
}

TEST(Interpretation, BareCloudSaysThatThereIsNoFreeSpaceEvidence) {
  ScanSet scans = scan_room(kitchen(), kOrigins, 0.002, 9);
  scans.free_space = false;
  const InterpretedMap map = interpreted(scans);
  EXPECT_THAT(map.notes, testing::Contains(testing::HasSubstr("no free-space evidence")));
  EXPECT_TRUE(map.semantics.links.contains("table_1"));
  EXPECT_FALSE(map.semantics.links.at("table_1").evidence.contains("seen_below"));
}

TEST(Interpretation, ChairSeatIsLeftOutWithANote) {
  AnalyticRoom room = kitchen();
  add_table(room, {0.6, 1.2}, {1.0, 1.6}, 0.45);                // a stool
  room.solids.push_back({{0.6, 1.57, 0.45}, {1.0, 1.6, 0.9}});  // with a back
  const InterpretedMap map = interpreted(scan_room(room, kOrigins, 0.002, 10));
  EXPECT_THAT(map.notes, testing::Contains(testing::HasSubstr("seat")));
  for (const auto& [name, link] : map.semantics.links)
    if (link.geometry.contains("height")) {
      EXPECT_GT(std::abs(link.geometry.at("height").get<double>() - 0.45), 0.05) << name;
    }
}

TEST(Interpretation, CounterThatOneCanWalkAroundIsAnIsland) {
  AnalyticRoom room;
  room.solids.push_back({{1.4, 1.1, 0}, {2.6, 1.8, 0.92}});
  const InterpretedMap map =
      interpreted(scan_room(room, {{0.6, 0.6, 1.6}, {3.4, 2.5, 1.6}, {0.6, 2.5, 1.6}}, 0.002, 12));
  ASSERT_TRUE(map.semantics.links.contains("island_1"));
  expect_box(outline_box(map, "island_1"), {1.4, 1.1}, {2.6, 1.8}, 0.03);
}

TEST(Interpretation, OpenDrawerIsNoShelf) {
  AnalyticRoom room = kitchen();
  room.solids.push_back({{1.0, 2.05, 0.55}, {1.6, 2.45, 0.65}});  // juts out from below the counter
  const InterpretedMap map = interpreted(scan_room(room, kOrigins, 0.002, 13));
  EXPECT_THAT(map.notes, testing::Contains(testing::HasSubstr("open drawer")));
  EXPECT_FALSE(map.semantics.links.contains("shelf_1"));
}

TEST(Interpretation, CounterRoundACornerIsOneSupportWithTwoBoxes) {
  AnalyticRoom room;
  room.solids.push_back({{0.0, 2.4, 0}, {3.0, 3.0, 0.9}});
  room.solids.push_back({{0.0, 0.8, 0}, {0.6, 2.4, 0.9}});
  const InterpretedMap map =
      interpreted(scan_room(room, {{2.0, 1.2, 1.6}, {3.0, 1.0, 1.5}, {1.2, 0.8, 1.5}}, 0.002, 14));
  ASSERT_TRUE(map.semantics.links.contains("counter_1"));
  EXPECT_FALSE(map.semantics.links.contains("counter_2"));
  EXPECT_EQ(map.world.find_link("counter_1")->collisions.size(), 2U);
  EXPECT_EQ(map.semantics.links.at("counter_1").geometry.at("outline").size(), 6U);
  expect_box(outline_box(map, "counter_1"), {0.0, 0.8}, {3.0, 3.0}, 0.04);
}

TEST(Interpretation, SameResultOnOneAndTwoThreads) {
  const ScanSet scans = scan_room(kitchen(), kOrigins, 0.003, 11);
  const InterpretedMap one = interpreted(scans, 1);
  const InterpretedMap two = interpreted(scans, 2);
  EXPECT_EQ(urdf_text(one.world), urdf_text(two.world));
  EXPECT_EQ(to_json(one.semantics), to_json(two.semantics));
  EXPECT_EQ(one.notes, two.notes);
}

TEST(Interpretation, RefusesAScanSetWithoutPoints) {
  EXPECT_THROW(interpreted(ScanSet{}), Error);
  ScanSet empty;
  empty.scans.emplace_back();
  empty.scans.back().origins.emplace_back(0.F, 0.F, 0.F);
  EXPECT_THROW(interpreted(empty), Error);
}

TEST(Interpretation, NoiseWithoutSurfacesGivesNothing) {
  ScanSet scans;
  Scan scan;
  scan.origins.emplace_back(0.F, 0.F, 1.5F);
  Random random(12);
  for (int i = 0; i < 50000; ++i) {
    ScanPoint point;
    for (int k = 0; k < 3; ++k) point.position[k] = static_cast<float>(random.uniform(-2, 2));
    scan.points.push_back(point);
  }
  scans.scans.push_back(std::move(scan));
  EXPECT_FALSE(interpreted(scans).usable());
}

TEST(Interpretation, OptionsOutOfBoundsAreAllNamed) {
  InterpretationOptions options;
  options.plane_tolerance_m = -1;
  options.min_wall_top_m = 100;
  NoProgress progress;
  try {
    interpret(scan_room(kitchen(), {kOrigins[0]}, 0, 1), options, progress);
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), testing::AllOf(testing::HasSubstr("plane_tolerance_m"),
                                             testing::HasSubstr("min_wall_top_m")));
  }
}

}  // namespace
}  // namespace loci::mapping::test
