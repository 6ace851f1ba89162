#include "apps/evaluate/mapping/figures.h"

#include <gmock/gmock.h>

#include <algorithm>

#include "apps/evaluate/mapping/mapper.h"

namespace loci::mapping_claim {
namespace {

ComparedThing handle(const std::string& verdict, std::optional<double> centre_error = {}) {
  ComparedThing thing;
  thing.kind = "handle";
  thing.verdict = verdict;
  thing.centre_error = centre_error;
  return thing;
}

const Figure& figure(const std::vector<Figure>& figures, const std::string& name) {
  return *std::ranges::find(figures, name, &Figure::name);
}

TEST(MappingFigures, CountFoundOfThoseAskedForAndRightOfThoseFound) {
  MappedWorld first, second;
  first.comparison.things = {handle("matched", 0.01), handle("matched", 0.02), handle("extra")};
  second.comparison.things = {handle("matched", 0.03), handle("missed"), handle("minor")};
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
  EXPECT_FALSE(figure(figures, "joint type").met);
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
  EXPECT_EQ(json["worlds"].size(), 2U);
  EXPECT_EQ(json["maps"].size(), 3U);
}

TEST(MappingFigures, JointsBeforeInteractionAreThoseThatTheShapeSuggests) {
  MapStructure map;
  map.fronts.resize(1);
  Front& front = map.fronts.front().front;
  front.centre = Vector3d(0, 0, 0.8);
  front.width = 0.6;
  front.height = 0.15;
  Fixture bar;
  bar.centre = front.centre + Vector3d(0.03, 0, 0);
  bar.axis = Vector3d::UnitY();
  bar.length = 0.2;
  front.fixture = bar;
  front.joint = JointEstimate{};
  front.joint->type = JointEstimate::Type::revolute;
  front.joint->evidence = "interaction";
  const Front before = with_prior_joints(map).fronts.front().front;
  EXPECT_EQ(before.joint->type, JointEstimate::Type::prismatic);
  EXPECT_EQ(before.joint->evidence, "prior");
}

}  // namespace
}  // namespace loci::mapping_claim
