#include "memory/belief/association/decisions.h"

#include <gtest/gtest.h>

namespace loci::memory::belief {
namespace {

/// Two observations of two objects: offsets in millimetres, distances of extents and colours in steps.
SceneMatrices scene(std::vector<uint16_t> offsets, std::vector<uint8_t> extents,
                    std::vector<uint8_t> colors) {
  SceneMatrices matrices;
  matrices.rows = 2;
  matrices.keys = {11, 12};
  matrices.objects = {1, 2};
  matrices.kinds = {"extents", "mean_color"};
  matrices.distances = {std::move(extents), std::move(colors)};
  matrices.offsets = std::move(offsets);
  return matrices;
}

TEST(Trackers, WhatAllSeeAlikeIsSettled) {
  const auto voted = votes(scene({5, 400, 400, 8}, {2, 60, 60, 3}, {1, 80, 80, 4}));
  ASSERT_EQ(voted.size(), 2U);
  EXPECT_EQ(voted[0].settled, 11);
  EXPECT_EQ(voted[1].settled, 12);
}

TEST(Trackers, OneThatDisagreesLeavesItToTheModel) {
  // They changed places: nearest is the other one.
  const auto voted = votes(scene({400, 5, 8, 400}, {2, 60, 60, 3}, {1, 80, 80, 4}));
  EXPECT_EQ(voted[0].key[0], 12);
  EXPECT_EQ(voted[0].key[2], 11);
  EXPECT_FALSE(voted[0].settled.has_value());
}

TEST(Trackers, SomethingElseNearByLeavesItToTheModel) {
  const auto voted = votes(scene({30, 70, 70, 30}, {2, 60, 60, 3}, {1, 80, 80, 4}));
  EXPECT_EQ(voted[0].key[0], 11);
  EXPECT_FALSE(voted[0].settled.has_value());
}

TEST(Trackers, WhereNothingCanBeComparedNothingIsProposed) {
  constexpr uint8_t no = SceneMatrices::kNone8;
  const auto voted = votes(scene({5, 400, 400, 8}, {no, no, no, no}, {1, 80, 80, 4}));
  EXPECT_FALSE(voted[0].key[1].has_value());
  EXPECT_FALSE(voted[0].settled.has_value());
  EXPECT_TRUE(votes(SceneMatrices{}).empty());
}

}  // namespace
}  // namespace loci::memory::belief
