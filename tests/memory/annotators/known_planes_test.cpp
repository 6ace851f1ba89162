#include "memory/annotators/known_planes.h"

#include <gtest/gtest.h>

#include "mapping/base/text/json.h"

namespace loci::memory {
namespace {

std::vector<Vector3d> rectangle(double x0, double y0, double x1, double y1, double z) {
  return {{x0, y0, z}, {x1, y0, z}, {x1, y1, z}, {x0, y1, z}};
}

TEST(KnownPlanes, PartsOfOneSurfaceHaveOneName) {
  KnownPlanes planes;
  EXPECT_EQ(planes.name(rectangle(0, 0, 1, 1, 0.72)), "plane_1");
  EXPECT_EQ(planes.name(rectangle(0.9, 0, 2, 1, 0.73)), "plane_1") << "the view moved on along the table";
  EXPECT_EQ(planes.name(rectangle(1.8, 0, 2.4, 1, 0.72)), "plane_1") << "it overlaps what was added";
}

TEST(KnownPlanes, OtherHeightOrPlaceIsAnotherSurface) {
  KnownPlanes planes;
  EXPECT_EQ(planes.name(rectangle(0, 0, 1, 1, 0.72)), "plane_1");
  EXPECT_EQ(planes.name(rectangle(0, 0, 1, 1, 0.92)), "plane_2");
  EXPECT_EQ(planes.name(rectangle(3, 0, 4, 1, 0.72)), "plane_3");
}

TEST(KnownPlanes, ComeBackFromJson) {
  KnownPlanes planes;
  planes.name(rectangle(0, 0, 1, 1, 0.1 + 0.2));
  planes.name(rectangle(5, 5, 6, 6, 0.72));
  KnownPlanes back = KnownPlanes::from_json(parse_json(planes.to_json().dump(), "test"));
  EXPECT_EQ(back.to_json(), planes.to_json());
  EXPECT_EQ(back.name(rectangle(5.5, 5, 7, 6, 0.72)), "plane_2");
}

}  // namespace
}  // namespace loci::memory
