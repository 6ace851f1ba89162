#include "mapping/exchange/comparison/compare.h"
#include "mapping/base/temporary_folder.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "mapping/base/files.h"
#include "mapping/base/text/json.h"
#include "mapping/world/urdf.h"

namespace loci::mapping {
namespace {

SurfacePatch rectangle(const std::string& name, double height, const Vector2d& low, const Vector2d& high) {
  return {name, "table", "", height, {{low, {high.x(), low.y()}, high, {low.x(), high.y()}}}, true};
}

WallPatch wall(const std::string& name, double offset) {
  WallPatch patch;
  patch.name = name;
  patch.normal = Vector3d(0, -1, 0);
  patch.offset = offset;
  patch.along_max = 3;
  patch.top = 2;
  return patch;
}

TEST(Compare, OverlapOfShiftedSquaresIsWhatGeometrySays) {
  const SurfacePatch a = rectangle("a", 1, {0, 0}, {1, 1});
  EXPECT_NEAR(overlap_of(a, rectangle("b", 1, {0.5, 0}, {1.5, 1})), 1.0 / 3, 0.01);
  EXPECT_EQ(overlap_of(a, rectangle("b", 1, {2, 2}, {3, 3})), 0);
}

TEST(Compare, OfAKindThatIsNotThereNoShareIsGiven) {
  MapStructure truth, map;
  truth.supports = {rectangle("table", 0.7, {0, 0}, {2, 1})};
  const Comparison result = compare(map, truth, {});
  EXPECT_FALSE(result.counts("support").precision());
  EXPECT_EQ(result.counts("support").recall(), 0);
  EXPECT_THAT(
      result.text(),
      testing::HasSubstr("supports: 0 matched, 1 missed, 0 extra, 0 minor; precision -, recall 0.00"));
  EXPECT_TRUE(result.report().at("supports").at("precision").is_null());
}

TEST(Compare, CountsMatchedMissedAndExtra) {
  MapStructure truth, map;
  truth.supports = {rectangle("table", 0.7, {0, 0}, {2, 1}), rectangle("counter", 0.9, {0, 3}, {2, 3.6})};
  map.supports = {rectangle("table_1", 0.71, {0.02, 0}, {2, 0.98}),
                  rectangle("shelf_1", 1.4, {5, 5}, {6, 6})};
  truth.walls = {wall("north", -3.6)};
  map.walls = {wall("wall_north", -3.58)};
  const Comparison result = compare(map, truth, {});
  const Comparison::Counts counts = result.counts("support");
  EXPECT_EQ(counts.matched, 1U);
  EXPECT_EQ(counts.missed, 1U);
  EXPECT_EQ(counts.extra, 1U);
  EXPECT_NEAR(counts.precision().value(), 0.5, 1e-9);
  EXPECT_NEAR(counts.recall().value(), 0.5, 1e-9);
  const ComparedElement& table = result.elements.front();
  EXPECT_EQ(table.truth_name, "table");
  EXPECT_NEAR(*table.height_error, 0.01, 1e-9);
  EXPECT_NEAR(table.edge_errors[0], 0.02, 1e-9);
  EXPECT_NEAR(table.edge_errors[3], -0.02, 1e-9);
  EXPECT_EQ(result.counts("wall").matched, 1U);
}

TEST(Compare, SupportsAboveTheSensorAreNotObservableUnlessTheyAreFound) {
  MapStructure truth, map;
  truth.supports = {rectangle("low", 1.2, {0, 0}, {1, 0.3}), rectangle("high", 1.5, {0, 0}, {1, 0.3}),
                    rectangle("found", 1.5, {3, 0}, {4, 0.3})};
  map.supports = {rectangle("shelf_1", 1.5, {3, 0}, {4, 0.3})};
  ComparisonOptions options;
  options.observable_height_m = 1.45;
  const Comparison result = compare(map, truth, options);
  const Comparison::Counts counts = result.counts("support");
  EXPECT_EQ(counts.matched, 1U);
  EXPECT_EQ(counts.missed, 1U);
  EXPECT_EQ(counts.not_observable, 1U);
  EXPECT_THAT(result.text(), testing::HasSubstr("1 not observable"));
  EXPECT_EQ(compare(map, truth, {}).counts("support").missed, 2U);
}

/// A truth with one wall, 4 m wide, that looks along +y and has an opening from x = -1.5 to -0.5.
Json truth_with_doorway() {
  return Json::parse(R"({"support_surfaces": [], "walls": [{"name": "south", "normal": [0, 1, 0], "offset": 0,
    "centre": [0, 0, 1.25], "right": [-1, 0, 0], "width": 4, "height": 2.5,
    "door_openings": [{"centre": [-1, 0, 1], "width": 1, "height": 2}]}]})");
}

/// The sidecar of a map of that wall: `openings` as the map has them.
MapStructure map_with_openings(const Json& openings) {
  SemanticMap sidecar;
  SemanticLink& wall = sidecar.links["wall_south"];
  wall.class_name = "wall";
  wall.geometry = {
      {"normal", {0, 1, 0}}, {"offset", 0}, {"outline", {{2, 0, 0}, {-2, 0, 0}, {-2, 0, 2.5}, {2, 0, 2.5}}}};
  if (!openings.empty()) wall.geometry["openings"] = openings;
  return structure_from_sidecar(sidecar, {}, "map.semantic.json");
}

TEST(Compare, DoorwaysOfATruthAreFoundMissedOrInvented) {
  const MapStructure truth = structure_from_truth(truth_with_doorway(), "truth.json");
  const Json doorway = {
      {"kind", "doorway"}, {"centre", {-1.02, 0.01, 0.99}}, {"width", 0.9}, {"height", 1.98}};
  const Json window = {{"kind", "window"}, {"centre", {1, 0, 1.5}}, {"width", 1}, {"height", 1}};
  const Comparison result = compare(map_with_openings(Json::array({doorway, window})), truth, {});
  const Comparison::Counts counts = result.counts("opening");
  EXPECT_EQ(counts.matched, 1U);
  EXPECT_EQ(counts.missed, 0U);
  EXPECT_EQ(counts.extra, 1U);
  const auto found = std::ranges::find(result.elements, "opening", &ComparedElement::kind);
  EXPECT_EQ(found->map_name, "wall_south.doorway_1");
  EXPECT_EQ(found->truth_name, "south.doorway_1");
  // From the room its right is -x: the left edge is at x = -0.57 for -0.5, the right one at -1.47 for -1.5.
  EXPECT_THAT(found->edge_errors,
              testing::ElementsAre(testing::DoubleNear(0.07, 1e-9), testing::DoubleNear(-0.03, 1e-9),
                                   testing::DoubleNear(0, 1e-9), testing::DoubleNear(-0.02, 1e-9)));
  EXPECT_THAT(result.text(), testing::HasSubstr("openings: 1 matched, 0 missed, 1 extra"));
  EXPECT_NEAR(result.report().at("openings").at("edge_error_m").at("max").get<double>(), 0.07, 1e-9);
  EXPECT_EQ(compare(map_with_openings(Json::array()), truth, {}).counts("opening").missed, 1U);
}

TEST(Compare, OpeningsAreNotAskedForWhereTheTruthIsSilentAboutThem) {
  Json silent = truth_with_doorway();
  silent["walls"][0].erase("door_openings");
  const Json window = {{"kind", "window"}, {"centre", {1, 0, 1.5}}, {"width", 1}, {"height", 1}};
  const Comparison result =
      compare(map_with_openings(Json::array({window})), structure_from_truth(silent, "truth.json"), {});
  EXPECT_EQ(result.counts("opening").extra, 0U);
  EXPECT_EQ(result.counts("wall").matched, 1U);
}

TEST(Compare, SideThingsOfTheTruthAreNeitherExtraNorMissed) {
  MapStructure truth, map;
  truth.supports = {rectangle("board", 1.2, {0, 0}, {1, 0.3}), rectangle("inside", 0.3, {0, 0}, {1, 0.3})};
  for (SurfacePatch& patch : truth.supports) patch.main = false;
  map.supports = {rectangle("shelf_1", 1.2, {0, 0}, {1, 0.3})};
  const Comparison::Counts counts = compare(map, truth, {}).counts("support");
  EXPECT_EQ(counts.minor, 1U);
  EXPECT_EQ(counts.missed, 0U);
  EXPECT_EQ(counts.extra, 0U);
}

TEST(Compare, SampleKitchenEqualsItselfBySidecarAndByGeometry) {
  const std::filesystem::path urdf = std::filesystem::path(LOCI_SOURCE_DIR) / "apps/samples/kitchen.urdf";
  if (!std::filesystem::exists(urdf)) GTEST_SKIP() << "no sample kitchen";
  Warnings warnings;
  const MeshSearch search{{}, urdf.parent_path()};
  const MapStructure sidecar = read_structure(urdf, search, warnings);
  EXPECT_EQ(compare(sidecar, sidecar, {}).counts("support").recall(), 1);
  const MapStructure geometry = structure_from_geometry(read_urdf(urdf), search, warnings);
  const Comparison result = compare(sidecar, geometry, {});
  EXPECT_EQ(result.counts("wall").matched, 4U) << result.text();
  EXPECT_EQ(result.counts("support").extra, 0U) << result.text();
}

std::string furniture(const std::string& name, const Vector3d& centre, const Vector3d& size,
                      const std::string& parent = "world") {
  return fmt::format(
      "<link name='{0}'><visual><geometry><box size='{1} {2} {3}'/></geometry></visual></link>"
      "<joint name='{0}_joint' type='fixed'><parent link='{7}'/><child link='{0}'/>"
      "<origin xyz='{4} {5} {6}'/></joint>",
      name, size.x(), size.y(), size.z(), centre.x(), centre.y(), centre.z(), parent);
}

/// A room of 4 × 3 m without names that say so, a counter, and a closed cabinet with a board.
std::string foreign_room(const std::string& wall, double floor) {
  std::string text = "<robot name='r'><link name='world'/>";
  for (const int side : {-1, 1}) {
    const std::string name = side < 0 ? "1" : "2";
    text += furniture(wall + "_x" + name, {side * 2.05, 0, floor + 1.25}, {0.1, 3.2, 2.5}) +
            furniture(wall + "_y" + name, {0, side * 1.55, floor + 1.25}, {4, 0.1, 2.5});
    text += furniture("seite_" + name, {1.7, side * 0.4, floor + 1}, {0.6, 0.02, 1.8}) +
            furniture("decke_" + name, {1.7, 0, floor + 1 + side * 0.9}, {0.6, 0.82, 0.02}) +
            furniture("blende_" + name, {1.7 + side * 0.3, 0, floor + 1}, {0.02, 0.82, 1.8});
  }
  return text + furniture("floor", {0, 0, floor - 0.05}, {4, 3, 0.1}) +
         furniture("theke", {-1.7, 0, floor + 0.88}, {0.6, 2, 0.04}) +
         furniture("brett", {1.7, 0, floor + 1}, {0.56, 0.76, 0.02}) + "</robot>";
}

TEST(Compare, WallsOfAForeignWorldAreWhatBoundsItAndBoardsInClosedCabinetsAreNotAskedFor) {
  Warnings warnings;
  const MapStructure structure =
      structure_from_geometry(parse_urdf(foreign_room("mauer", 0), "room.urdf"), {}, warnings);
  EXPECT_EQ(std::ranges::count_if(structure.walls, &WallPatch::main), 4);
  for (const SurfacePatch& surface : structure.supports)
    if (surface.name == "brett" || surface.name == "theke") {
      EXPECT_EQ(surface.main, surface.name == "theke") << surface.name;
    }
}

TEST(Compare, ACabinetCalledAWallIsNone) {
  std::string text = foreign_room("wall", 0);
  text.replace(text.find("</robot>"), 8,
               furniture("wall_stack", {0, 1.2, 1}, {0.6, 0.6, 2}) +
                   "<link name='door'/><joint name='hinge' type='continuous'><parent link='wall_stack'/>"
                   "<child link='door'/></joint></robot>");
  Warnings warnings;
  for (const WallPatch& patch : structure_from_geometry(parse_urdf(text, "room.urdf"), {}, warnings).walls)
    if (patch.name == "wall_stack") {
      EXPECT_FALSE(patch.main);
    }
}

TEST(Compare, AWorldWhoseFloorIsNotAtZeroIsMovedIntoTheFrameOfTheMap) {
  const TemporaryFolder folder("compare");
  const std::filesystem::path level = folder.path() / "level.urdf", low = folder.path() / "low.urdf";
  write_file_atomically(level, foreign_room("wall", 0));
  write_file_atomically(low, foreign_room("wall", -0.45));
  Warnings warnings;
  const Isometry3d up(Eigen::Translation3d(0, 0, 0.45));
  const MapStructure map = read_structure(level, {}, warnings);
  const auto missed = [&](const MapStructure& truth) {
    return compare(map, truth, {}).counts("support").missed;
  };
  EXPECT_GT(missed(read_structure(low, {}, warnings)), 0U);
  EXPECT_EQ(missed(read_structure(low, {}, warnings, up)), 0U);
  EXPECT_EQ(missed(read_structure(level, {}, warnings, up)), 0U);  // It is level as it is.
}

TEST(Compare, ReadsTruthJsonWithRegions) {
  const std::filesystem::path truth =
      std::filesystem::path(LOCI_SHARED_DIR) / "data/iai_apartment/truth.json";
  if (!std::filesystem::exists(truth)) GTEST_SKIP() << "no shared data";
  Warnings warnings;
  const MapStructure structure = read_structure(truth, {}, warnings);
  EXPECT_EQ(structure.source, "truth.json");
  ComparisonOptions options;
  options.region = "kitchen";
  EXPECT_EQ(compare({}, structure, options).counts("support").missed, 2U);  // countertop and island
}

TEST(Compare, RefusesJsonThatIsNoTruth) {
  const TemporaryFolder folder("loci_test");
  const std::filesystem::path path = folder.path() / "no_truth.json";
  write_json(path, {{"something", 1}});
  Warnings warnings;
  EXPECT_THROW(read_structure(path, {}, warnings), Error);
  EXPECT_THROW(structure_from_truth(Json::parse(R"({"support_surfaces": [{"name": "x"}]})"), "t.json"),
               Error);
}

}  // namespace
}  // namespace loci::mapping
