#include "mapping/exchange/map_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mapping/base/text/html.h"
#include "mapping/exchange/map_drawings.h"
#include "mapping/exchange/map_views.h"
#include "tests/mapping/exchange/furnished_map.h"
#include "tests/mapping/exchange/photographed_map.h"

namespace loci::mapping {
namespace {

TEST(MapReport, IsOnePageWithTopViewLinksAndNotes) {
  InterpretedMap map;
  SemanticLink table;
  table.class_name = "table";
  table.confidence = 0.9;
  table.geometry = {{"height", 0.72}, {"outline", {{0, 0}, {1, 0}, {1, 1}, {0, 1}}}};
  table.evidence = {{"inliers", 10}, {"scans", {0}}};
  map.semantics.links["table_1"] = table;
  map.notes = {"left out: <small>"};
  map.configuration = {{"plane_tolerance_m", 0.02}};
  ScanSet scans;
  Scan scan;
  for (int i = 0; i < 100; ++i) {
    ScanPoint point;
    point.position = {0.1F * static_cast<float>(i % 10), 0.1F * static_cast<float>(i / 10), 0.7F};
    scan.points.push_back(point);
  }
  scans.scans.push_back(scan);
  const std::string page = map_report(map, scans, "scans");
  EXPECT_THAT(
      page,
      testing::AllOf(testing::StartsWith("<!doctype html>"), testing::HasSubstr("<svg"),
                     testing::HasSubstr("data:image/png;base64,"), testing::HasSubstr("table_1"),
                     testing::HasSubstr("left out: &lt;small&gt;"), testing::HasSubstr("plane_tolerance_m")));
  for (const char* from : {"<script src", "href=\"http", "@import"})  // it needs no other file
    EXPECT_THAT(page, testing::Not(testing::HasSubstr(from)));
  const std::string grown = html_with_section(page, "day", html_section("day", "Day", "<p>one</p>"));
  EXPECT_GT(grown.size(), page.size());
  EXPECT_THAT(html_with_section(grown, "day", html_section("day", "Day", "<p>two</p>")),
              testing::AllOf(testing::HasSubstr("two"), testing::Not(testing::HasSubstr("one</p>"))));
}

TEST(MapReport, DrawsEachRunOfFurnitureAndSaysWhatOpensAndWhatIsUnsure) {
  const test::FurnishedMap furnished;
  InterpretedMap map;
  map.world = furnished.world;
  map.semantics = furnished.semantics;
  map.semantics.links.at("door_1").confidence = 0.4;
  map.semantics.links.at("door_1").extra["blocked_by"] = "counter_1";
  const std::vector<FurnitureRun> runs = furniture_runs(map);
  ASSERT_EQ(runs.size(), 1U);
  ASSERT_EQ(runs[0].fronts.size(), 3U);
  EXPECT_EQ(runs[0].fronts[0].name, "drawer_1");  // the leftmost of who stands before them
  EXPECT_THAT(elevation_svg(map, runs[0]),
              testing::AllOf(testing::HasSubstr("drawer_1"), testing::HasSubstr("60 × 20")));
  const std::string page = map_report(map, {}, "scans");
  EXPECT_THAT(page, testing::AllOf(testing::HasSubstr("door, hinge on the left"),
                                   testing::HasSubstr("then it meets counter_1"),
                                   testing::HasSubstr("door_1: its edges are unsure"),
                                   testing::HasSubstr("0.160 m long")));
  EXPECT_THAT(page, testing::Not(testing::HasSubstr("offset 0.000 m")));
}

/// Four walls of 4.4 m and 4.2 m that stand askew in the map.
InterpretedMap turned_room() {
  InterpretedMap map;
  const Eigen::Rotation2Dd turn(0.75);
  const std::vector<Vector2d> corners = {turn * Vector2d(0, 0), turn * Vector2d(4.4, 0),
                                         turn * Vector2d(4.4, 4.2), turn * Vector2d(0, 4.2)};
  for (size_t i = 0; i < 4; ++i) {
    const Vector2d &a = corners[i], &b = corners[(i + 1) % 4];
    SemanticLink& wall = map.semantics.links["wall_" + std::to_string(i + 1)];
    wall.class_name = "wall";
    wall.geometry = {
        {"outline", {{a.x(), a.y(), 0}, {b.x(), b.y(), 0}, {b.x(), b.y(), 2}, {a.x(), a.y(), 2}}}};
  }
  return map;
}

SemanticLink surface(const char* class_name, const Vector2d& low, const Vector2d& high) {
  SemanticLink link;
  link.class_name = class_name;
  link.confidence = 1;
  link.geometry = {
      {"height", 0.9},
      {"outline", {{low.x(), low.y()}, {high.x(), low.y()}, {high.x(), high.y()}, {low.x(), high.y()}}}};
  return link;
}

TEST(Plan, DimensionsAreAlongTheWallsOfARoomThatStandsAskew) {
  const std::string svg = plan_svg(turned_room());
  EXPECT_THAT(svg, testing::AllOf(testing::HasSubstr(">440</text>"), testing::HasSubstr(">420</text>")));
}

TEST(Plan, AShelfDoesNotHideTheNameOfTheCounterBelow) {
  InterpretedMap map;
  map.semantics.links["counter_1"] = surface("counter", {0, 0}, {3, 0.6});
  map.semantics.links["shelf_1"] = surface("shelf", {1, 0.1}, {2, 0.5});
  const std::string svg = plan_svg(map);
  EXPECT_GT(svg.find(">counter_1</text>"), svg.rfind("<polygon"));
  EXPECT_NE(svg.find(">counter_1</text>"), std::string::npos);
  EXPECT_NE(svg.find(">shelf_1</text>"), std::string::npos);
}

TEST(TopView, ShowsAllOfTheRoomAndNamesFurnitureOnce) {
  InterpretedMap map = turned_room();
  map.semantics.links["counter_1"] = surface("counter", {0, 2}, {2, 2.6});
  map.semantics.links["drawer_1_bottom"] = surface("drawer_bottom", {0.1, 2}, {0.6, 2.5});
  const std::string svg = top_view_svg(map, {});
  EXPECT_THAT(svg, testing::HasSubstr(">counter_1</text>"));
  EXPECT_THAT(svg, testing::Not(testing::HasSubstr("drawer_1_bottom")));
  for (size_t at = svg.find("points=\""); at != std::string::npos; at = svg.find("points=\"", at + 1))
    EXPECT_NE(svg[at + 8], '-');
  EXPECT_THAT(svg, testing::Not(testing::HasSubstr(",-")));
}

TEST(MapReport, GivesBothEdgesOfACabinet) {
  InterpretedMap map;
  map.semantics.links["cabinet_1"] = surface("cabinet", {0, 0}, {1, 0.6});
  map.semantics.links["cabinet_1"].geometry["height"] = 0.103;
  map.semantics.links["cabinet_1"].geometry["top"] = 0.86;
  EXPECT_THAT(map_report(map, {}, "scans"), testing::HasSubstr("0.103 m to 0.860 m high"));
}

/// Times that a part stands in a text.
size_t count_of(const std::string& text, const std::string& part) {
  size_t count = 0;
  for (size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

TEST(MapReport, DrawsFrontsOverThePhotoAndShowsWhatIsUnsureAndLeftOut) {
  InterpretedMap map = test::photographed_map();
  const std::vector<FurnitureRun> runs = furniture_runs(map);
  EXPECT_THAT(elevation_svg(map, runs.at(0)), testing::HasSubstr("<image"));
  map.semantics.links.at("front_1").confidence = 0.4;
  map.notes = {"the object before the face at (0.50, 1.38, 0.50) is no fixture: it is large",
               "horizontal surface of 0.50 x 0.50 m at (0.10, 0.20), 0.46 m high left out: a seat",
               "no walls were recognised"};
  const std::string page = map_report(map, {}, "scans");
  EXPECT_EQ(count_of(page, "<img"), 3U) << "of the front, the object and the surface";
  EXPECT_THAT(page, testing::HasSubstr("<li>no walls were recognised"));
}

TEST(MapReport, HoldsTheModelThatItIsGiven) {
  const InterpretedMap map = test::photographed_map();
  EXPECT_THAT(map_report(map, {}, "scans", "glTF bytes"),
              testing::AllOf(testing::HasSubstr("data:model/gltf-binary;base64,Z2xURiBieXRlcw=="),
                             testing::HasSubstr("<canvas")));
  EXPECT_THAT(map_report(map, {}, "scans"), testing::Not(testing::HasSubstr("<canvas")));
}

TEST(MapReport, ShowsAtMostSoManyImagesOfWhatWasLeftOut) {
  InterpretedMap map = test::photographed_map();
  map.notes.assign(100, "the object before the face at (0.50, 1.38, 0.50) is no fixture: it is large");
  EXPECT_LT(count_of(map_report(map, {}, "scans"), "<img"), 40U);
}

}  // namespace
}  // namespace loci::mapping
