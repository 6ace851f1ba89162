#include "mapping/base/text/natural_order.h"

#include <gmock/gmock.h>

#include <set>
#include <string>

namespace loci {
namespace {

TEST(NaturalOrder, CountsWithTheNumbersInNames) {
  const std::set<std::string, NaturalOrder> names = {"door_10",      "door_2",  "door", "door_1", "drawer_1",
                                                     "door_2_front", "door_01", "",     "9",      "10"};
  EXPECT_THAT(names, testing::ElementsAre("", "9", "10", "door", "door_01", "door_1", "door_2",
                                          "door_2_front", "door_10", "drawer_1"));
}

}  // namespace
}  // namespace loci
