#include "mapping/base/math/label_places.h"

#include <gtest/gtest.h>

namespace loci {
namespace {

using Eigen::Vector2d;

TEST(LabelPlaces, ALabelStandsInTheArmOfAnLWithRoomForIt) {
  const Polygon counter = {{0, 0}, {4, 0}, {4, 1}, {1, 1}, {1, 3}, {0, 3}};
  LabelPlaces places;
  const auto at = places.take_inside(counter, {1.5, 0.3});
  ASSERT_TRUE(at);
  EXPECT_NEAR(at->y(), 0.5, 0.1);
  EXPECT_TRUE(contains(counter, *at - Vector2d(0.75, 0.15)));
  EXPECT_TRUE(contains(counter, *at + Vector2d(0.75, 0.15)));
}

TEST(LabelPlaces, ALabelStandsInsideATurnedRectangle) {
  const Polygon island = {{0, 0}, {2, 2}, {1, 3}, {-1, 1}};
  LabelPlaces places;
  const auto at = places.take_inside(island, {0.8, 0.2});
  ASSERT_TRUE(at);
  EXPECT_NEAR((*at - Vector2d(0.5, 1.5)).norm(), 0, 0.1);
}

TEST(LabelPlaces, LabelsDoNotCoverEachOther) {
  const Polygon table = {{0, 0}, {4, 0}, {4, 1}, {0, 1}};
  LabelPlaces places;
  const auto first = places.take_inside(table, {1, 0.4}), second = places.take_inside(table, {1, 0.4});
  ASSERT_TRUE(first && second);
  EXPECT_TRUE(std::abs(first->x() - second->x()) >= 1 || std::abs(first->y() - second->y()) >= 0.4);
  EXPECT_FALSE(places.take_first({*first, *second}, {1, 0.4}));
}

TEST(LabelPlaces, WhatDoesNotFitStandsAboutTheInnermostPoint) {
  const Polygon board = {{0, 0}, {2, 0}, {2, 0.2}, {0, 0.2}};
  LabelPlaces places;
  EXPECT_FALSE(places.take_inside(board, {1, 0.4}));
  const auto at = places.take_about(board, {1, 0.4});
  ASSERT_TRUE(at);
  EXPECT_NEAR((*at - Vector2d(1, 0.1)).norm(), 0, 0.05);
  const auto beside = places.take_about(board, {0.5, 0.4});  // the middle is taken
  ASSERT_TRUE(beside);
  EXPECT_TRUE(contains(board, *beside));
  EXPECT_GE(std::abs(beside->x() - at->x()), 0.75);
}

}  // namespace
}  // namespace loci
