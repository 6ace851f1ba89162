#include "mapping/exchange/map_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mapping/base/text/html.h"
#include "mapping/exchange/map_drawings.h"
#include "tests/mapping/exchange/furnished_map.h"

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

}  // namespace
}  // namespace loci::mapping
