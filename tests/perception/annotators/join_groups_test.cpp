#include <gmock/gmock.h>

#include "perception/annotators/segmentation/clustering/convex_parts.h"

namespace loci::perception {
namespace {

using ::testing::Each;

/// An image of three upright stripes, each a group of its own: what stands at which depth.
struct Stripes {
  static constexpr int kWidth = 12, kHeight = 8;
  std::vector<int> pixels, groups;
  int count = 3;

  Stripes() {
    for (int pixel = 0; pixel < kWidth * kHeight; ++pixel) {
      pixels.push_back(pixel);
      groups.push_back(stripe(pixel));
    }
  }
  static int stripe(int pixel) { return pixel % kWidth / 4; }
  static int row(int pixel) { return pixel / kWidth; }

  std::vector<int> joined(const std::function<bool(int, int)>& goes_on) {
    return join_groups(groups, pixels, {kWidth, kHeight}, goes_on, count);
  }
};

TEST(JoinGroups, JoinsWhatGoesOnOverMostOfTheContact) {
  Stripes stripes;
  EXPECT_THAT(stripes.joined([](int from, int) { return Stripes::row(from) < 5; }), Each(0));
  EXPECT_EQ(stripes.count, 1);
}

TEST(JoinGroups, LeavesApartWhatDoesNot) {
  Stripes stripes;
  EXPECT_EQ(stripes.joined([](int from, int) { return Stripes::row(from) < 4; }), stripes.groups);
  EXPECT_EQ(stripes.count, 3);
}

TEST(JoinGroups, JoinsNothingAcrossTheImageBorder) {
  Stripes stripes;
  stripes.joined([](int from, int to) { return Stripes::stripe(from) != 1 && Stripes::stripe(to) != 1; });
  EXPECT_EQ(stripes.count, 3);
}

}  // namespace
}  // namespace loci::perception
