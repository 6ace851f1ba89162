#include "mapping/base/math/tally.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mapping/base/text/json.h"

namespace loci {
namespace {

using testing::HasSubstr;

TEST(Tally, NamesTheReasonsByFrequency) {
  Tally tally;
  tally.add(Reason::no_pose, 2);
  tally.add(Reason::no_plane, 3);
  tally.add_used();
  EXPECT_EQ(tally.total(), 6U);
  EXPECT_EQ(tally.reasons(), "no supporting plane in 3, no pose of the camera in 2");
  EXPECT_THAT(tally.hint(), HasSubstr("min_area_m2"));
  EXPECT_EQ(tally.report().dump(), R"({"total":6,"used":1,"reasons":{"no_pose":2,"no_plane":3}})");
}

TEST(Tally, GivesTheFirstExampleOfAReason) {
  Tally tally, other;
  tally.add(Reason::no_pose);
  other.add(Reason::damaged, "a.png: the image is truncated");
  other.add(Reason::damaged, "b.png: the image is truncated");
  tally.add(other);
  EXPECT_EQ(tally.reasons(),
            "an image that cannot be read in 2 (a.png: the image is truncated), no pose of the camera in 1");
}

TEST(Tally, FewerThanATenthOfUsableFramesIsAnError) {
  Tally tally;
  tally.add(Reason::no_plane, 91);
  tally.add(Reason::support_empty, 9);
  Warnings warnings;
  try {
    tally.explain("object", {"here", 0, {}}, warnings);
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("here: no object found in 100 frames: no supporting plane in 91, "
                                        "nothing on the supports in 9; show a table"));
  }
  tally.add(Reason::support_empty, 2);
  tally.explain("object", {"here", 0, {}}, warnings);
  ASSERT_EQ(warnings.texts().size(), 1U);
  EXPECT_THAT(warnings.texts()[0], HasSubstr("no object found in 102 frames"));
}

TEST(Tally, FewUsedFramesAreAnErrorToo) {
  Tally tally;
  tally.add(Reason::damaged, 91);
  for (int i = 0; i < 9; ++i) tally.add_used();
  Warnings warnings;
  try {
    tally.explain("frame", {"here", 0, {}}, warnings);
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("here: only 9 of 100 frames could be used: an image that cannot be "
                                        "read in 91; copy"));
  }
  for (int i = 0; i < 2; ++i) tally.add_used();
  tally.explain("frame", {"here", 0, {}}, warnings);
  EXPECT_TRUE(warnings.empty());
}

TEST(Tally, NothingToDoIsNoFailure) {
  Warnings warnings;
  Tally().explain("object", {}, warnings);
  EXPECT_TRUE(warnings.empty());
}

}  // namespace
}  // namespace loci
