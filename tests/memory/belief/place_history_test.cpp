#include "memory/belief/place_history.h"

#include <gtest/gtest.h>

namespace loci::memory::belief {
namespace {

TEST(PlaceHistory, WhatWasPutDownBeforeAWholeViewIsSeen) {
  PlaceHistory place;
  place.add_view(100, 1);
  EXPECT_DOUBLE_EQ(place.unseen_seconds(0, 100), 0);
  EXPECT_DOUBLE_EQ(place.unseen_seconds(0, 160), 60);
  EXPECT_DOUBLE_EQ(place.unseen_share(0, 400), 0.75);
  EXPECT_DOUBLE_EQ(place.never_seen, 0);
}

TEST(PlaceHistory, PartialViewsLeaveASharePerView) {
  PlaceHistory place;
  place.add_view(0, 0.5);
  place.add_view(100, 0.5);
  place.add_view(200, 0.5);
  EXPECT_DOUBLE_EQ(place.never_seen, 0.125);
  EXPECT_DOUBLE_EQ(place.unseen_seconds(0, 300), 100 + 50 + 25);
  EXPECT_DOUBLE_EQ(place.unseen_seconds(150, 250), 50 + 25);
}

TEST(PlaceHistory, FramesOfAVideoAreOneView) {
  PlaceHistory place;
  for (int i = 0; i < 10; ++i) place.add_view(0.1 * i, 0.5);
  EXPECT_EQ(place.views.size(), 1U);
  EXPECT_DOUBLE_EQ(place.never_seen, 0.5);
}

TEST(PlaceHistory, KeepsNoMoreViewsThanCount) {
  PlaceHistory place;
  for (int i = 0; i < 1000; ++i) place.add_view(60.0 * i, i % 2 == 0 ? 0.9 : 0.05);
  EXPECT_LE(place.views.size(), 6U);
  EXPECT_NEAR(place.unseen_seconds(0, 60.0 * 1000), 60 * (1 + 0.95 + 0.095 * 2), 15);
}

}  // namespace
}  // namespace loci::memory::belief
