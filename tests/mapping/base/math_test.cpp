#include "mapping/base/math/math.h"

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

TEST(Quantiles, AreThoseThatOneAtATimeGives) {
  std::vector<int> values{7, 3, 9, 1, 5, 8, 2, 6, 4, 0, 10};
  for (const auto& [low, high] : {std::pair(0.0, 1.0), {0.02, 0.98}, {0.5, 0.5}, {0.3, 0.35}}) {
    std::vector<int> copy = values;
    EXPECT_EQ(quantiles(copy, low, high), std::pair(quantile(values, low), quantile(values, high)));
  }
}

}  // namespace
}  // namespace loci
