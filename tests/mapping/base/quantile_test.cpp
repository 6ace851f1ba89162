#include "mapping/base/quantile.h"

#include <gtest/gtest.h>

namespace loci {
namespace {

TEST(Quantile, IsTheElementOfNearestRank) {
  const std::vector<double> values{40, 10, 30, 20, 50};
  EXPECT_EQ(quantile(values, 0), 10);
  EXPECT_EQ(quantile(values, 0.25), 20);
  EXPECT_EQ(quantile(values, 0.9), 50);
  EXPECT_EQ(quantile(values, 1), 50);
  EXPECT_EQ(quantile(std::vector<float>{7}, 0.3), 7);
}

TEST(Quantile, MedianOfAnEvenNumberIsTheUpperOne) {
  EXPECT_EQ(median(std::vector<double>{3, 1, 2}), 2);
  EXPECT_EQ(median(std::vector<double>{4, 3, 1, 2}), 3);
}

}  // namespace
}  // namespace loci
