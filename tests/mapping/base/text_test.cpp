#include "mapping/base/text/text.h"

#include <gtest/gtest.h>

namespace loci {
namespace {

TEST(Text, CountsInSingularAndPlural) {
  EXPECT_EQ(counted(1, "box"), "1 box");
  EXPECT_EQ(counted(2, "box"), "2 boxes");
  EXPECT_EQ(counted(0, "scene"), "0 scenes");
  EXPECT_EQ(counted(3, "shelf"), "3 shelves");
  EXPECT_EQ(counted(3, "knife"), "3 knives");
  EXPECT_EQ(counted(2, "body"), "2 bodies");
  EXPECT_EQ(counted(2, "day"), "2 days");
}

}  // namespace
}  // namespace loci
