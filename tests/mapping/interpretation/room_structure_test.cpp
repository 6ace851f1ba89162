#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mapping/base/text/json.h"
#include "mapping/interpretation/furniture/names.h"
#include "mapping/interpretation/interpretation.h"
#include "mapping/world/urdf.h"
#include "tests/mapping/interpretation/synthetic_room.h"

namespace loci::mapping::test {
namespace {

InterpretedMap interpreted_room(const ScanSet& scans) {
  NoProgress progress;
  return interpret(scans, {}, progress);
}

const std::vector<Vector3d> kLaserOrigins = {
    {0.8, 1.9, 1.25}, {2.0, 1.7, 1.25}, {3.2, 1.7, 1.25}, {3.3, 0.5, 1.25}, {0.7, 0.5, 1.25}};

/// As high as a tilting laser looks.
constexpr double kUp = 0.78;

std::vector<Vector2d> outline_of(const InterpretedMap& map, const std::string& name) {
  std::vector<Vector2d> outline;
  for (const Json& corner : map.semantics.links.at(name).geometry.at("outline"))
    outline.emplace_back(corner.at(0).get<double>(), corner.at(1).get<double>());
  return outline;
}

bool inside(const std::vector<Vector2d>& polygon, const Vector2d& at) {
  bool odd = false;
  for (size_t i = 0; i < polygon.size(); ++i) {
    const Vector2d& a = polygon[i];
    const Vector2d& b = polygon[(i + 1) % polygon.size()];
    if ((a.y() < at.y()) != (b.y() < at.y()) &&
        at.x() < a.x() + (at.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x()))
      odd = !odd;
  }
  return odd;
}

/// Intersection over union of an outline and a region, by centimetres in a room of 4 × 3 m.
template <class Region>
double overlap(const std::vector<Vector2d>& outline, const Region& region) {
  double shared = 0;
  double both = 0;
  for (double x = 0.005; x < 4; x += 0.01)
    for (double y = 0.005; y < 3; y += 0.01) {
      const bool a = inside(outline, {x, y});
      const bool b = region(Vector2d(x, y));
      shared += a && b;
      both += a || b;
    }
  return shared / both;
}

TEST(RoomStructure, WallThatIsSeenFromBothSidesIsFoundOnBoth) {
  AnalyticRoom room;
  room.solids.push_back({{2.0, 0.0, 0.0}, {2.1, 1.6, 2.5}});
  const InterpretedMap map = interpreted_room(scan_room(
      room, {{0.8, 0.8, 1.25}, {3.2, 0.8, 1.25}, {2.0, 2.4, 1.25}, {0.6, 2.2, 1.25}}, 0.002, 21, kUp));
  size_t east_face = 0;
  size_t west_face = 0;
  for (const auto& [name, link] : map.semantics.links) {
    if (link.class_name != "wall") continue;
    const double x = link.geometry.at("normal").at(0).get<double>();
    const double offset = link.geometry.at("offset").get<double>();
    east_face += x > 0.99 && std::abs(offset - 2.1) < 0.01;
    west_face += x < -0.99 && std::abs(offset + 2.0) < 0.01;
  }
  EXPECT_EQ(east_face, 1U);
  EXPECT_EQ(west_face, 1U);
}

/// A wall across the room with a doorway and a window.
AnalyticRoom two_rooms() {
  AnalyticRoom room;
  for (const auto& [low, high] : std::vector<std::pair<Vector3d, Vector3d>>{{{2, 0, 0}, {2.1, 0.6, 2.5}},
                                                                            {{2, 0.6, 2.0}, {2.1, 1.5, 2.5}},
                                                                            {{2, 1.5, 0}, {2.1, 1.9, 2.5}},
                                                                            {{2, 1.9, 0}, {2.1, 2.6, 1.1}},
                                                                            {{2, 1.9, 1.7}, {2.1, 2.6, 2.5}},
                                                                            {{2, 2.6, 0}, {2.1, 3.0, 2.5}}})
    room.solids.push_back({low, high});
  return room;
}

TEST(RoomStructure, DoorwaysAndWindowsAreOpeningsOfTheirWall) {
  const std::vector<Vector3d> origins = {
      {0.7, 0.7, 1.25}, {1.0, 2.2, 1.25}, {3.3, 1.2, 1.25}, {3.0, 2.3, 1.25}};
  const InterpretedMap map = interpreted_room(scan_room(two_rooms(), origins, 0.004, 3, kUp));
  size_t faces = 0;
  for (const auto& [name, link] : map.semantics.links) {
    if (link.class_name != "wall") continue;
    const double x = link.geometry.at("outline").at(0).at(0).get<double>();
    if (std::abs(x - 2.05) > 0.1) {
      EXPECT_FALSE(link.geometry.contains("openings")) << name;
      continue;
    }
    ++faces;
    SCOPED_TRACE(name);
    std::map<std::string, Json> openings;
    ASSERT_TRUE(link.geometry.contains("openings"));
    for (const Json& opening : link.geometry.at("openings")) openings[opening.at("kind")] = opening;
    ASSERT_EQ(openings.size(), 2U) << link.geometry.at("openings").dump();
    const auto expect = [](const Json& opening, double y, double z, double width, double height) {
      EXPECT_NEAR(opening.at("centre").at(1).get<double>(), y, 0.03);
      EXPECT_NEAR(opening.at("centre").at(2).get<double>(), z, 0.04);
      EXPECT_NEAR(opening.at("width").get<double>(), width, 0.04);
      EXPECT_NEAR(opening.at("height").get<double>(), height, 0.06);
    };
    expect(openings["doorway"], 1.05, 1.0, 0.9, 2.0);
    expect(openings["window"], 2.25, 1.4, 0.7, 0.6);
    EXPECT_EQ(map.world.find_link(name)->visuals.size(), 6U) << "around the openings";
  }
  EXPECT_EQ(faces, 2U);
}

TEST(RoomStructure, WhatFurnitureHidesOfAWallIsNoOpening) {
  AnalyticRoom room = kitchen();
  room.solids.push_back({{3.0, 2.5, 0}, {3.6, 3.0, 2.0}});
  const InterpretedMap map = interpreted_room(scan_room(room, kLaserOrigins, 0.004, 3, kUp));
  for (const auto& [name, link] : map.semantics.links)
    EXPECT_FALSE(link.geometry.contains("openings")) << name;
}

TEST(RoomStructure, TallCupboardBelowTheCeilingIsNoWall) {
  AnalyticRoom room;
  room.solids.push_back({{0.5, 2.4, 0}, {2.9, 3.0, 2.1}});
  const InterpretedMap map = interpreted_room(scan_room(room, kLaserOrigins, 0.002, 22, kUp));
  std::vector<std::string> walls;
  for (const auto& [name, link] : map.semantics.links)
    if (link.class_name == "wall") walls.push_back(name + " " + link.geometry.at("offset").dump());
  EXPECT_EQ(walls.size(), 4U) << testing::PrintToString(walls);
}

TEST(RoomStructure, AnUprightPillarUpToTheCeilingHasAWallOnEachSide) {
  AnalyticRoom room;
  room.solids.push_back({{1.88, 1.0, 0}, {2.12, 1.22, 2.5}});
  const InterpretedMap map = interpreted_room(scan_room(room, kLaserOrigins, 0.002, 24, kUp));
  size_t sides = 0;
  for (const auto& [name, link] : map.semantics.links) {
    if (link.class_name != "wall") continue;
    Vector2d middle = Vector2d::Zero();
    for (const Vector2d& corner : outline_of(map, name)) middle += corner / 4;
    if ((middle - Vector2d(2.0, 1.11)).norm() < 0.2) ++sides;
  }
  EXPECT_EQ(sides, 4U) << testing::PrintToString(map.notes);
}

/// Whether a box before the north wall, up to the ceiling, is found to have a wall as its front; every 200th
/// measurement of that is 5 cm too near.
bool has_wall_before(AnalyticRoom room) {
  room.solids.push_back({{1.7, 2.65, 0}, {2.3, 3.0, 2.5}});
  ScanSet scans = scan_room(room, kLaserOrigins, 0.002, 24, kUp);
  size_t number = 0;
  for (Scan& scan : scans.scans)
    for (ScanPoint& point : scan.points) {
      const Vector3d at = scan.map_from_scan * point.position.cast<double>();
      if (std::abs(at.y() - 2.65) > 0.01 || std::abs(at.x() - 2) > 0.3 || ++number % 200 != 0) continue;
      point.position.y() -= 0.05F;
    }
  const InterpretedMap map = interpreted_room(scans);
  return std::ranges::any_of(map.semantics.links, [&](const auto& link) {
    if (link.second.class_name != "wall") return false;
    Vector2d middle = Vector2d::Zero();
    for (const Vector2d& corner : outline_of(map, link.first)) middle += corner / 4;
    return (middle - Vector2d(2, 2.65)).norm() < 0.1;
  });
}

TEST(RoomStructure, TheBroadFaceOfAChimneyIsAWallAndThatOfATallUnitWithAHandleIsNone) {
  EXPECT_TRUE(has_wall_before({}));
  AnalyticRoom unit;
  unit.solids.push_back({{1.75, 2.60, 0.9}, {1.77, 2.62, 1.3}});
  EXPECT_FALSE(has_wall_before(unit));
}

TEST(RoomStructure, RoundTableHasARoundOutline) {
  AnalyticRoom room;
  room.solids.push_back({{1.4, 0.6, 0.71}, {2.4, 1.6, 0.74}, 0, true});
  room.solids.push_back({{1.85, 1.05, 0.0}, {1.95, 1.15, 0.71}, 0, true});
  const InterpretedMap map = interpreted_room(scan_room(room, kLaserOrigins, 0.002, 23));
  ASSERT_TRUE(map.semantics.links.contains("table_1"));
  const auto disc = [](const Vector2d& at) { return (at - Vector2d(1.9, 1.1)).norm() < 0.5; };
  EXPECT_GT(overlap(outline_of(map, "table_1"), disc), 0.95);
  const Link* link = map.world.find_link("table_1");
  EXPECT_TRUE(std::holds_alternative<Cylinder>(link->collisions.front().geometry));
  const Json& footprints = map.semantics.links.at("table_1_legs").geometry.at("footprints");
  ASSERT_EQ(footprints.size(), 1U);  // its pedestal
  for (const Json& corner : footprints[0]) {
    const Vector2d at(corner.at(0).get<double>(), corner.at(1).get<double>());
    EXPECT_LT((at - Vector2d(1.9, 1.1)).norm(), 0.08);
  }
}

/// Fronts below a slab that stands out 2 cm before them, along the north wall.
void add_counter(AnalyticRoom& room, double from, double to) {
  room.solids.push_back({{from, 2.42, 0}, {to, 3.0, 0.87}});
  room.solids.push_back({{from, 2.4, 0.87}, {to, 3.0, 0.9}});
}

TEST(RoomStructure, CounterGoesOnBehindAnApplianceThatStandsOnIt) {
  AnalyticRoom room;
  add_counter(room, 0.5, 2.9);
  room.solids.push_back({{2.35, 2.41, 0.9}, {2.82, 3.0, 1.25}});  // as deep as the slab
  const InterpretedMap map = interpreted_room(scan_room(room, kLaserOrigins, 0.002, 31));
  ASSERT_TRUE(map.semantics.links.contains("counter_1"));
  const auto slab = [](const Vector2d& at) { return at.x() > 0.5 && at.x() < 2.9 && at.y() > 2.4; };
  EXPECT_GT(overlap(outline_of(map, "counter_1"), slab), 0.95);
}

TEST(RoomStructure, CounterGoesOnBelowAnApplianceUpToItsEnd) {
  AnalyticRoom room;
  add_counter(room, 0.5, 2.9);
  room.solids.push_back({{2.5, 2.41, 0.9}, {2.9, 3.0, 1.3}});
  const InterpretedMap map = interpreted_room(scan_room(room, kLaserOrigins, 0.002, 33));
  ASSERT_TRUE(map.semantics.links.contains("counter_1"));
  const auto slab = [](const Vector2d& at) { return at.x() > 0.5 && at.x() < 2.9 && at.y() > 2.4; };
  EXPECT_GT(overlap(outline_of(map, "counter_1"), slab), 0.95);
}

TEST(RoomStructure, CounterThatAnAppliancePartsInTwoIsOne) {
  AnalyticRoom room;
  add_counter(room, 0.3, 3.6);
  room.solids.push_back({{1.7, 2.41, 0.9}, {2.3, 3.0, 1.3}});
  const InterpretedMap map = interpreted_room(scan_room(room, kLaserOrigins, 0.002, 34));
  ASSERT_TRUE(map.semantics.links.contains("counter_1"));
  EXPECT_FALSE(map.semantics.links.contains("counter_2"));
  const auto slab = [](const Vector2d& at) { return at.x() > 0.3 && at.x() < 3.6 && at.y() > 2.4; };
  EXPECT_GT(overlap(outline_of(map, "counter_1"), slab), 0.95);
}

TEST(RoomStructure, CounterGoesOnBelowTheBlackGlassOfAHob) {
  AnalyticRoom room;
  add_counter(room, 0.5, 2.9);
  ScanSet scans = scan_room(room, kLaserOrigins, 0.002, 36);
  const Eigen::AlignedBox3d glass(Vector3d(2.3, 2.46, 0.88), Vector3d(2.84, 2.94, 0.92));
  for (Scan& scan : scans.scans)
    for (ScanPoint& point : scan.points) {
      if (!glass.contains(scan.map_from_scan * point.position.cast<double>())) continue;
      point.returned = false;
      point.position *= static_cast<float>(scans.range_max) / point.position.norm();
    }
  const InterpretedMap map = interpreted_room(scans);
  ASSERT_TRUE(map.semantics.links.contains("counter_1"));
  const auto slab = [](const Vector2d& at) { return at.x() > 0.5 && at.x() < 2.9 && at.y() > 2.4; };
  EXPECT_GT(overlap(outline_of(map, "counter_1"), slab), 0.95);
}

TEST(RoomStructure, CounterEndsAtARefrigeratorThatIsLittleHigher) {
  AnalyticRoom room;
  add_counter(room, 0.5, 2.2);
  room.solids.push_back({{2.2, 2.41, 0}, {2.8, 3.0, 1.3}});
  const InterpretedMap map = interpreted_room(scan_room(room, kLaserOrigins, 0.002, 35));
  ASSERT_TRUE(map.semantics.links.contains("counter_1"));
  for (const Vector2d& corner : outline_of(map, "counter_1")) EXPECT_LT(corner.x(), 2.25);
}

TEST(RoomStructure, WhatLiesBetweenTheWingsOfACounterIsNone) {
  AnalyticRoom room;
  room.solids.push_back({{0.0, 2.4, 0}, {4.0, 3.0, 0.9}});
  room.solids.push_back({{0.0, 0.9, 0}, {0.6, 2.4, 0.9}});
  room.solids.push_back({{3.4, 1.2, 0}, {4.0, 2.4, 0.9}});
  // From outside of the U its aisle is seen at a flat angle.
  const std::vector<Vector3d> origins = {{0.3, 0.3, 1.25}, {3.7, 0.3, 1.25}, {3.7, 0.8, 1.25}};
  const InterpretedMap map = interpreted_room(scan_room(room, origins, 0.002, 33));
  std::vector<std::vector<Vector2d>> counters;
  for (const auto& [name, link] : map.semantics.links)
    if (link.class_name == "counter") counters.push_back(outline_of(map, name));
  double claimed = 0;
  for (double x = 0.005; x < 4; x += 0.01)
    for (double y = 0.005; y < 3; y += 0.01) {
      const bool found = std::ranges::any_of(counters, [&](const auto& one) { return inside(one, {x, y}); });
      claimed += 1e-4 * (found && !(y > 2.4 || (x < 0.6 && y > 0.9) || (x > 3.4 && y > 1.2)));
    }
  EXPECT_LT(claimed, 0.1) << "square metres of the aisle";
}

TEST(RoomStructure, APassageWithoutLintelIsAnOpening) {
  AnalyticRoom room;
  room.solids.push_back({{2.0, 0, 0}, {2.1, 0.8, 2.5}});
  room.solids.push_back({{2.0, 1.9, 0}, {2.1, 3.0, 2.5}});
  const std::vector<Vector3d> origins = {
      {0.7, 0.7, 1.25}, {1.0, 2.2, 1.25}, {3.3, 1.2, 1.25}, {3.0, 2.3, 1.25}};
  const InterpretedMap map = interpreted_room(scan_room(room, origins, 0.004, 3, kUp));
  size_t faces = 0;
  for (const auto& [name, link] : map.semantics.links) {
    if (link.class_name != "wall") continue;
    const Json& outline = link.geometry.at("outline");
    const auto y = [&](size_t corner) { return outline.at(corner).at(1).get<double>(); };
    if (std::abs(outline.at(0).at(0).get<double>() - 2.05) > 0.1) continue;
    if (std::abs(y(0) - y(1)) < 1.5) continue;  // a wall that ends at the passage
    ++faces;
    ASSERT_TRUE(link.geometry.contains("openings")) << name;
    EXPECT_NEAR(link.geometry.at("openings").at(0).at("width").get<double>(), 1.1, 0.05) << name;
  }
  EXPECT_EQ(faces, 2U);
}

TEST(RoomStructure, CounterEndsAtAPassage) {
  AnalyticRoom room;
  add_counter(room, 0.5, 2.2);
  add_counter(room, 2.7, 2.9);
  room.solids.push_back({{1.9, 2.41, 0.9}, {2.2, 3.0, 1.25}});  // Stands at the passage, on one side.
  const InterpretedMap map = interpreted_room(scan_room(room, kLaserOrigins, 0.002, 32));
  ASSERT_TRUE(map.semantics.links.contains("counter_1"));
  for (const Vector2d& corner : outline_of(map, "counter_1")) EXPECT_LT(corner.x(), 2.25);
}

TEST(RoomStructure, TableAskewToTheRoomKeepsItsOwnDirection) {
  AnalyticRoom room;
  const double yaw = 0.5;
  room.solids.push_back({{1.4, 0.7, 0.71}, {2.6, 1.4, 0.74}, yaw});
  room.solids.push_back({{1.9, 0.95, 0.0}, {2.1, 1.15, 0.71}, yaw});
  const InterpretedMap map = interpreted_room(scan_room(room, kLaserOrigins, 0.002, 24));
  ASSERT_TRUE(map.semantics.links.contains("table_1"));
  const auto top = [&](const Vector2d& at) {
    const Vector2d own = Eigen::Rotation2Dd(-yaw) * (at - Vector2d(2.0, 1.05));
    return std::abs(own.x()) < 0.6 && std::abs(own.y()) < 0.35;
  };
  EXPECT_GT(overlap(outline_of(map, "table_1"), top), 0.93);
}

TEST(RoomStructure, EmptyRoomIsAValidMapOfFloorAndWalls) {
  const InterpretedMap map = interpreted_room(scan_room({}, kLaserOrigins, 0.002, 25));
  EXPECT_TRUE(map.usable());
  for (const auto& [name, link] : map.semantics.links)
    EXPECT_THAT(link.class_name, testing::AnyOf("floor", "ceiling", "wall")) << name;
  EXPECT_EQ(map.semantics.links.count("floor"), 1U);
  EXPECT_EQ(parse_urdf(urdf_text(map.world), "map.urdf").links.size(), map.world.links.size());
  for (const Vector2d& corner : {Vector2d(0, 0), Vector2d(4, 0), Vector2d(4, 3), Vector2d(0, 3)}) {
    size_t meeting = 0;
    for (const auto& [name, link] : map.semantics.links)
      for (size_t end = 0; link.class_name == "wall" && end < 2; ++end)
        meeting += (outline_of(map, name).at(end) - corner).norm() < 0.02;
    EXPECT_EQ(meeting, 2U) << corner.transpose();
  }
}

void turn_over(Scan& scan) {
  for (ScanPoint& point : scan.points) point.position.tail<2>() *= -1;
}

TEST(RoomStructure, ScansThatAreUpsideDownAreRefused) {
  ScanSet scans = scan_room(kitchen(), kLaserOrigins, 0.002, 26);
  for (Scan& scan : scans.scans) turn_over(scan);
  try {
    interpreted_room(scans);
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("upside down"));
  }
}

TEST(RoomStructure, OneBadScanIsNamedAndDoesNotSpoilTheMap) {
  ScanSet scans = scan_room(kitchen(), kLaserOrigins, 0.002, 27);
  turn_over(scans.scans[1]);
  scans.scans[4].points.clear();
  const InterpretedMap map = interpreted_room(scans);
  EXPECT_THAT(map.notes, testing::Contains(testing::AllOf(testing::HasSubstr("upside down"),
                                                          testing::HasSubstr(scans.scans[1].name))));
  EXPECT_THAT(map.notes, testing::Contains(testing::AllOf(testing::HasSubstr("without returns"),
                                                          testing::HasSubstr(scans.scans[4].name))));
  EXPECT_TRUE(map.semantics.links.contains("table_1"));
}

TEST(RoomStructure, AScanFromBelowTheTopsIsNotTakenForUpsideDown) {
  AnalyticRoom room = kitchen();
  room.solids.push_back({{0.5, 2.5, 1.4}, {2.9, 3.0, 2.1}});  // wall cupboards
  std::vector<Vector3d> origins = kLaserOrigins;
  origins[1].z() = 0.6;
  const ScanSet scans = scan_room(room, origins, 0.002, 29, kUp);
  EXPECT_THAT(interpreted_room(scans).notes,
              testing::Not(testing::Contains(testing::HasSubstr("upside down"))));
}

TEST(RoomStructure, NamesOfAnOlderMapAreTakenOver) {
  const InterpretedMap before = interpreted_room(scan_room(kitchen(), kLaserOrigins, 0.002, 28));
  SemanticMap older = before.semantics;
  const auto rename = [&](const std::string& from, const std::string& to) {
    auto node = older.links.extract(from);
    node.key() = to;
    older.links.insert(std::move(node));
  };
  rename("counter_1", "counter_7");
  rename("wall_north", "wall_with_the_clock");
  older.links.at("table_1").aliases = {"the dining table"};
  AnalyticRoom room = kitchen();
  room.solids.push_back({{3.4, 0.4, 0}, {4.0, 1.4, 0.9}});  // bought since
  InterpretedMap now = interpreted_room(scan_room(room, kLaserOrigins, 0.002, 29));
  const NameTransfer names = transfer_names(now.world, now.semantics, older);
  for (const char* name : {"counter_7", "wall_with_the_clock", "table_1", "floor"}) {
    EXPECT_TRUE(now.semantics.links.contains(name)) << name;
    EXPECT_NE(now.world.find_link(name), nullptr) << name;
    EXPECT_NE(now.world.find_joint(std::string(name) + "_joint"), nullptr) << name;
  }
  EXPECT_EQ(now.semantics.links.at("table_1").aliases.size(), 1U);
  EXPECT_TRUE(names.vanished.empty());
  ASSERT_EQ(names.added.size(), 1U);
  EXPECT_FALSE(older.links.contains(names.added.front()));
}

}  // namespace
}  // namespace loci::mapping::test
