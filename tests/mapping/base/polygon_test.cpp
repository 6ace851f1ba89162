#include "mapping/base/math/polygon.h"

#include <gtest/gtest.h>

namespace loci {
namespace {

const Polygon kSquare{{0, 0}, {1, 0}, {1, 1}, {0, 1}};

TEST(PolygonTest, SharedAreaIsThatOfBoth) {
  const Polygon diamond{{0.5, -0.5}, {1.5, 0.5}, {0.5, 1.5}, {-0.5, 0.5}};
  const Polygon right{{0.75, -1}, {2, -1}, {2, 3}, {0.75, 3}};
  EXPECT_DOUBLE_EQ(shared_area(kSquare, diamond), 1);
  EXPECT_DOUBLE_EQ(shared_area(kSquare, right), 0.25);
  EXPECT_DOUBLE_EQ(shared_area(right, kSquare), 0.25);
  EXPECT_EQ(shared_area(kSquare, {{1.5, 0}, {2, 0}, {2, 1}}), 0);
}

TEST(PolygonTest, CoincidingSidesAndDirectionsDoNotMatter) {
  const Polygon other_way(kSquare.rbegin(), kSquare.rend());
  EXPECT_DOUBLE_EQ(shared_area(kSquare, other_way), 1);
  EXPECT_DOUBLE_EQ(shared_area(other_way, kSquare), 1);
  const Polygon measured{{1.4003, 0.4992}, {2.5998, 0.4992}, {2.5997, 1.2997}, {1.4002, 1.2996}};
  const Polygon again{{1.4002, 0.4986}, {2.5998, 0.4987}, {2.5997, 1.2998}, {1.4001, 1.2997}};
  EXPECT_GT(shared_area(measured, again), 0.998 * area_of(measured));
}

TEST(PolygonTest, ContainsWhatItsBaysLeave) {
  const Polygon corner{{0, 0}, {3, 0}, {3, 1}, {1, 1}, {1, 3}, {0, 3}};
  EXPECT_TRUE(contains(corner, {2, 0.5}));
  EXPECT_TRUE(contains(corner, {0.5, 2}));
  EXPECT_FALSE(contains(corner, {2, 2})) << "within its hull only";
  EXPECT_FALSE(contains(corner, {-1, 0.5}));
  EXPECT_FALSE(contains({{0, 0}, {1, 1}}, {0.5, 0.5}));
  EXPECT_DOUBLE_EQ(distance_to_edge(corner, {2, 2}), 1);
  EXPECT_DOUBLE_EQ(distance_to_edge(corner, {2, 0.75}), 0.25);
}

}  // namespace
}  // namespace loci
