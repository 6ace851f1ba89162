#include "mapping/image/root_sift.h"

#include <gtest/gtest.h>

namespace loci::mapping {
namespace {

TEST(RootSift, IsTheSquareRootOfShares) {
  const cv::Mat rooted = root_sift((cv::Mat_<float>(2, 3) << 4, 16, 80, 0, 0, 0));
  EXPECT_NEAR(rooted.at<float>(0, 0), 0.2, 1e-6);
  EXPECT_NEAR(rooted.at<float>(0, 1), 0.4, 1e-6);
  EXPECT_NEAR(cv::norm(rooted.row(0)), 1, 1e-6);
  EXPECT_EQ(cv::norm(rooted.row(1)), 0);
  EXPECT_TRUE(root_sift(cv::Mat()).empty());
}

}  // namespace
}  // namespace loci::mapping
