#include <gmock/gmock.h>

#include "mapping/base/text/json.h"
#include "tests/cli/command.h"
#include "tests/support/box_table.h"

namespace loci::apps::test {
namespace {

using loci::test::table_camera;
using ::testing::HasSubstr;
using ::testing::Not;

/// A table with boxes, seen once.
class Goal : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fresh_folder();
    loci::test::record_table(
        folder_ + "/recording", 1, [](int64_t) { return loci::test::BoxTable{table_camera(0.15)}; },
        [](int64_t) { return std::optional(table_camera(0.15)); });
  }
  Outcome look_for(const std::string& goal, const std::string& more = "") const {
    return run("loci-perceive run " + folder_ + "/recording --goal \"" + goal + "\" " + more);
  }
  /// A colour that is seen.
  std::string some_color() const {
    const Outcome outcome = look_for("color=purple", "--json");
    EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
    return parse_json(outcome.out, "run")["terms"][0]["seen"][0];
  }
  std::string folder_;
};

TEST_F(Goal, WhatFitsIsNamedWithItsPositionAndMemory) {
  const std::string color = some_color();
  const Outcome outcome = look_for("color=" + color);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
  EXPECT_THAT(outcome.out, HasSubstr(") fits\n"));
  const Outcome with_memory = look_for("color=" + color, "--json -m " + folder_ + "/m.loci");
  const Json found = parse_json(with_memory.out, "run")["found"];
  ASSERT_FALSE(found.empty()) << with_memory.error;
  EXPECT_EQ(found[0]["position"].size(), 3U);
  EXPECT_THAT(found[0].value("object", ""), HasSubstr("object_"));
}

TEST_F(Goal, WhatNothingFitsIsSaidWithWhatWasSeen) {
  const Outcome outcome = look_for("class=unicorn");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
  EXPECT_THAT(outcome.out, HasSubstr("nothing fits class=unicorn"));
  EXPECT_THAT(look_for("color=Gray").out, HasSubstr("color=grey"));
  EXPECT_THAT(look_for("color=plaid").error, HasSubstr("'plaid' is the name of no colour"));
}

TEST_F(Goal, WhatWasNotTestedDoesNotFit) {
  const Outcome outcome = look_for("color=" + some_color() + " product=tea");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
  EXPECT_THAT(outcome.out, HasSubstr("not tested: product=tea"));
  EXPECT_THAT(outcome.out, Not(HasSubstr(" fits\n")));
  EXPECT_THAT(outcome.out, HasSubstr("it cannot start without options"));
  const Outcome none = look_for("color=red", "--budget-ms 1");
  EXPECT_EQ(none.exit_code, 1);
  EXPECT_THAT(none.error, HasSubstr("no annotator can test color=red"));
}

}  // namespace
}  // namespace loci::apps::test
