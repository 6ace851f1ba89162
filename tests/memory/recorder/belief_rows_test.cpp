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

class RowsOfAJar : public ::testing::Test {
 protected:
  RowsOfAJar() {
    belief::ProtoObject& jar = after_.objects.emplace_back();
    jar.key = jar.id = 1;
    jar.status = belief::Status::present;
    jar.box = {{0, 0, 0.8}, {0.02, 0.06, 0.05}};
    jar.partial = true;
    record_.row.time = 1000 * kSecond;
  }
  ~RowsOfAJar() override { std::filesystem::remove(file_); }

  BeliefRows rows(std::map<Id, BeliefRow> before = {}) const {
    return belief_rows({store_, record_, {}, 1, {}, update_, after_, options_, {}, before});
  }

  std::filesystem::path file_ =
      std::filesystem::temp_directory_path() / ("loci_rows_of_jar_" + std::to_string(::getpid()) + ".loci");
  const Store store_ = Store::open_write(file_);
  SceneRecord record_;
  belief::BeliefState after_;
  belief::BeliefUpdate update_;
  const belief::BeliefOptions options_;
};

TEST_F(RowsOfAJar, APartIsNotSmallerThanTheWholeWas) {
  EXPECT_TRUE(rows().beliefs.front().size->isApprox(Vector3d(0.02, 0.06, 0.05))) << "nothing else is known";
  std::map<Id, BeliefRow> whole;
  whole[1].object = 1;
  whole[1].size = Vector3d(0.12, 0.05, 0.1);
  EXPECT_TRUE(rows(whole).beliefs.front().size->isApprox(Vector3d(0.05, 0.12, 0.1)))
      << "turned as the part is";
  after_.objects.front().partial = false;
  EXPECT_TRUE(rows(whole).beliefs.front().size->isApprox(Vector3d(0.02, 0.06, 0.05)))
      << "a whole view decides";
}

TEST_F(RowsOfAJar, WhatAViewOfLittleShowsToHaveLeftIsMissed) {
  belief::ObjectOutcome& outcome = update_.objects.emplace_back();
  outcome.key = outcome.object = 1;
  outcome.visibility = {.hidden = 0.8, .seen_through = 0.2};
  outcome.explanation = Explanation::hidden;
  EXPECT_EQ(rows().visibility.at(0).status, ObjectStatus::hidden);
  outcome.explanation = Explanation::disappear;
  EXPECT_EQ(rows().visibility.at(0).status, ObjectStatus::missed);
}

}  // namespace
}  // namespace loci::memory
