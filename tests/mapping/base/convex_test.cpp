#include "mapping/base/math/convex.h"

#include <gtest/gtest.h>

namespace loci {
namespace {

const Polygon kSquare{{0, 0}, {1, 0}, {1, 1}, {0, 1}};

TEST(Convex, SharedAreaIsThatOfBoth) {
  const Polygon diamond{{0.5, -0.5}, {1.5, 0.5}, {0.5, 1.5}, {-0.5, 0.5}};
  const Polygon right{{0.75, -1}, {2, -1}, {2, 3}, {0.75, 3}};
  EXPECT_DOUBLE_EQ(shared_area(kSquare, diamond), 1);
  EXPECT_DOUBLE_EQ(shared_area(kSquare, right), 0.25);
  EXPECT_DOUBLE_EQ(shared_area(right, kSquare), 0.25);
  EXPECT_EQ(shared_area(kSquare, {{1.5, 0}, {2, 0}, {2, 1}}), 0);
}

TEST(Convex, CoincidingSidesAndDirectionsDoNotMatter) {
  const Polygon other_way(kSquare.rbegin(), kSquare.rend());
  EXPECT_DOUBLE_EQ(shared_area(kSquare, other_way), 1);
  EXPECT_DOUBLE_EQ(shared_area(other_way, kSquare), 1);
  const Polygon measured{{1.4003, 0.4992}, {2.5998, 0.4992}, {2.5997, 1.2997}, {1.4002, 1.2996}};
  const Polygon again{{1.4002, 0.4986}, {2.5998, 0.4987}, {2.5997, 1.2998}, {1.4001, 1.2997}};
  EXPECT_GT(shared_area(measured, again), 0.998 * area_of(measured));
}

}  // namespace
}  // namespace loci
