#include "apps/evaluate/mapping/figures.h"

#include <gmock/gmock.h>

#include <algorithm>

#include "mapping/base/text/json.h"

namespace loci::apps::mapping_claim {
namespace {

mapping::ComparedElement handle(const std::string& verdict, std::optional<double> centre_error = {}) {
  mapping::ComparedElement object;
  object.kind = "handle";
  object.verdict = verdict;
  object.centre_error = centre_error;
  return object;
}

const Figure& figure(const std::vector<Figure>& figures, const std::string& name) {
  return *std::ranges::find(figures, name, &Figure::name);
}

TEST(MappingFigures, CountFoundOfThoseAskedForAndRightOfThoseFound) {
  MappedWorld first, second;
  first.before.elements = {handle("matched", 0.01), handle("matched", 0.02), handle("extra")};
  second.before.elements = {handle("matched", 0.03), handle("missed"), handle("minor")};
  const std::vector<Figure> figures = figures_of({&first, &second});
  EXPECT_NEAR(figure(figures, "handles found").value, 75, 1e-9);
  EXPECT_FALSE(figure(figures, "handles found").met);
  EXPECT_NEAR(figure(figures, "handles not invented").value, 80, 1e-9);
  EXPECT_NEAR(figure(figures, "handle centre, mean").value, 2, 1e-9);
  EXPECT_NEAR(figure(figures, "handle centres within 1.5 cm").value, 100.0 / 3, 1e-9);
}

TEST(MappingFigures, WhatCannotBeMeasuredIsNotMet) {
  MappedWorld nothing;
  const std::vector<Figure> figures = figures_of({&nothing});
  EXPECT_FALSE(figure(figures, "handles found").known);
  EXPECT_FALSE(figure(figures, "handles found").met);
  EXPECT_FALSE(figure(figures, "joint type after").met);
}

TEST(MappingFigures, TableHasAColumnPerWorldOverItsSeeds) {
  MappedWorld a, b;
  a.world = "kitchens/first.urdf";
  b.world = "kitchens/second.urdf";
  a.scans = 3;
  const std::string text = table_text({a, a, b});
  EXPECT_THAT(text, testing::HasSubstr("first"));
  EXPECT_THAT(text, testing::HasSubstr("second"));
  const Json json = table_json({a, a, b});
  EXPECT_EQ(json["worlds"].size(), 3U);  // and all together
  EXPECT_EQ(json["maps"].size(), 3U);
}

TEST(MappingFigures, FrontsAndJointsAreShownBeforeAndAfterPulling) {
  const auto front = [](double overlap, const std::string& type) {
    mapping::ComparedElement object;
    object.kind = "front";
    object.verdict = "matched";
    object.overlap = overlap;
    object.joint = mapping::ComparedJoint{type, "prismatic", "prior", {}, false, {}};
    return object;
  };
  MappedWorld map;
  map.before.elements = {front(0.6, "revolute")};
  EXPECT_FALSE(figure(figures_of({&map}), "front IoU after, mean").known);
  map.after = mapping::Comparison{{front(0.9, "prismatic")}, "", ""};
  const std::vector<Figure> figures = figures_of({&map});
  EXPECT_NEAR(figure(figures, "front IoU before pulling, mean").value, 0.6, 1e-9);
  EXPECT_NEAR(figure(figures, "front IoU after, mean").value, 0.9, 1e-9);
  EXPECT_NEAR(figure(figures, "joint type before pulling").value, 0, 1e-9);
  EXPECT_NEAR(figure(figures, "joint type after").value, 100, 1e-9);
}

}  // namespace
}  // namespace loci::apps::mapping_claim
