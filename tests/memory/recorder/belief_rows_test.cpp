// What is written of a belief: how it fades until the next row.

#include "memory/recorder/belief_rows.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

namespace loci::memory {
namespace {

TEST(BeliefRowsTest, WhatAPlaceWasUsedForIsNotLostTwice) {
  const std::filesystem::path file =
      std::filesystem::temp_directory_path() / ("loci_belief_rows_" + std::to_string(::getpid()) + ".loci");
  const Store store = Store::open_write(file);
  belief::BeliefState after;
  belief::ProtoObject& object = after.objects.emplace_back();
  object.key = object.id = 1;
  object.status = belief::Status::present;
  object.probability_here = 1;
  object.place = "drawer_1";
  object.uses = 3;  // the drawer was opened since the object was seen
  SceneRecord record;
  record.row.time = 1000 * kSecond;
  const belief::BeliefUpdate update;
  const belief::BeliefOptions options;
  const BeliefRows rows =
      belief_rows({store, record, {}, 1, {}, update, after, options, {{"drawer_1", 1}}, {}});
  ASSERT_EQ(rows.beliefs.size(), 1U);
  const BeliefRow& row = rows.beliefs.front();
  EXPECT_LT(row.probability, 0.95) << "it may have been taken";
  ASSERT_TRUE(row.fade_s && row.fade_to);
  EXPECT_GT(*row.fade_s, 1) << "readers divide by it";
  EXPECT_NEAR(faded(row, row.then + kSecond), row.probability, 0.01) << "nobody opened it once more";
  std::filesystem::remove(file);
}

}  // namespace
}  // namespace loci::memory
