#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "apps/evaluate/placement/experiment.h"
#include "mapping/base/text/json.h"

namespace loci::apps::placement_claim {
namespace {

using testing::HasSubstr;
using testing::Not;

Trial trial(const std::string& map, double stretch, Outcome outcome, double error_m) {
  Trial trial;
  trial.map = map;
  trial.visit = std::string("a");
  trial.stretch = stretch;
  trial.outcome = outcome;
  trial.error_m = error_m;
  return trial;
}

TEST(PlacementFigures, CountEachKindOfRoomForItself) {
  const std::vector<Trial> trials = {trial("a", 0, Outcome::right, 0.01), trial("a", 0, Outcome::right, 0.03),
                                     trial("b", 0, Outcome::wrong, 0), trial("a", 0.04, Outcome::refused, 0)};
  EXPECT_TRUE(trials[0].own_room());
  EXPECT_FALSE(trials[2].own_room());
  EXPECT_FALSE(trials[3].own_room());
  const std::string text = table_text(trials, false);
  EXPECT_THAT(text, HasSubstr("its own room                  2      0        0   30, 30 mm"));
  EXPECT_THAT(text, HasSubstr("another room                  0      1        0\n"));
  EXPECT_THAT(text, HasSubstr("its own, 4 % longer           0      0        1\n"));
  EXPECT_THAT(text, Not(HasSubstr("in the map of")));
  const Json json = table_json(trials);
  ASSERT_EQ(json.size(), 4U);
  EXPECT_EQ(json[0]["error_m"], 0.01);
  EXPECT_FALSE(json[2].contains("error_m"));
  EXPECT_EQ(json[3]["outcome"].get<std::string>(), std::string("refused"));
}

}  // namespace
}  // namespace loci::apps::placement_claim
