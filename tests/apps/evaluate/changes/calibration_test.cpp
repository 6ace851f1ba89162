#include "apps/evaluate/changes/calibration.h"

#include <gtest/gtest.h>

namespace loci::apps::changes {
namespace {

TEST(Calibration, HasBinsOfEqualCount) {
  Stated stated;
  for (int i = 0; i < 60; ++i) stated.emplace_back(i < 30 ? 0.2 : 0.9, i % 2 == 0);
  const std::vector<ReliabilityBin> bins = reliability_bins(stated);
  ASSERT_EQ(bins.size(), 2U);
  EXPECT_EQ(bins[0].count, 30U);
  EXPECT_NEAR(bins[0].stated, 0.2, 1e-12);
  EXPECT_NEAR(bins[1].right, 0.5, 1e-12);
  EXPECT_NEAR(calibration_error(stated), (0.3 + 0.4) / 2, 1e-12);
  EXPECT_NEAR(brier_score({{0.8, true}, {0.5, false}}), (0.04 + 0.25) / 2, 1e-12);
}

TEST(Calibration, OfNoStatementIsEmpty) {
  EXPECT_TRUE(reliability_bins({}).empty());
  EXPECT_EQ(calibration_error({}), 0);
  EXPECT_EQ(brier_score({}), 0);
}

TEST(Calibration, DrawsKindsWithStatements) {
  const std::string svg = reliability_diagrams({{"place", {{0.7, true}}}, {"was", {}}});
  EXPECT_NE(svg.find(">place<"), std::string::npos);
  EXPECT_EQ(svg.find(">was<"), std::string::npos);
  EXPECT_NE(svg.find("of 1</title>"), std::string::npos);
}

}  // namespace
}  // namespace loci::apps::changes
