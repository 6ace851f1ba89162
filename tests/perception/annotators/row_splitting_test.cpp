#include "perception/annotators/segmentation/clustering/row_splitting.h"

#include <gtest/gtest.h>

#include "mapping/simulation/scenario.h"
#include "perception/annotators/segmentation/clustering/object_clusters.h"
#include "perception/annotators/structure/normals.h"
#include "tests/perception/annotators/synthetic_table.h"

namespace loci::perception {
namespace {

using test::SyntheticTable;

SyntheticTable far_table(const Vector3d& eye) {
  SyntheticTable table;
  table.camera = {640, 480, 585, 585, 320, 240};
  table.map_from_camera = mapping::looking_at(eye, {0, 0, 0.05});
  return table;
}

/// How many clusters there are, and of how many labels (1, 2, ...) one cluster shows three quarters or more.
std::pair<size_t, int> found_on(const SyntheticTable& table, int labels) {
  cv::Mat shown;
  const cv::Mat depth = smooth_depth(table.render(0.1, shown), table.camera, NormalOptions::for_objects());
  const cv::Mat points = points_from_depth(depth, table.camera);
  const cv::Mat normals = normals_from_depth(depth, table.camera, NormalOptions::for_objects());
  const std::vector<SupportPlane> supports =
      find_supports(points, normals, table.camera, table.up(), SupportOptions());
  const std::vector<ObjectCluster> clusters =
      extract_clusters({points, normals, {}, {}}, table.camera, supports, ClusterOptions());
  int found = 0;
  for (int label = 1; label <= labels; ++label)
    for (const ObjectCluster& cluster : clusters) {
      const auto both =
          std::ranges::count_if(cluster.pixels, [&](int pixel) { return shown.ptr<int>()[pixel] == label; });
      const auto either = std::ssize(cluster.pixels) + cv::countNonZero(shown == label) - both;
      found += 4 * both >= 3 * either ? 1 : 0;
    }
  return {clusters.size(), found};
}

TEST(RowSplitting, CupsInAnObliqueRowFarAwayAreObjectsOfTheirOwn) {
  struct Case {
    double distance, turn;  // metres, radians from the line of sight
  };
  for (const auto& [distance, turn] : {Case{2.8, 0.7}, Case{2.4, 0.7}, Case{2.8, 0.85}}) {
    SyntheticTable table = far_table({0.1, -distance, 0.9});
    for (const double along : {-0.14, 0.0, 0.14})
      table.bowls.push_back({{along * std::sin(turn), along * std::cos(turn), 0}, 0.1, 0.042, 0.042});
    EXPECT_EQ(found_on(table, 3), std::pair(size_t{3}, 3)) << distance << " " << turn;
  }
}

TEST(RowSplitting, TheFarWallOfAVesselIsNoObject) {
  for (const double radius : {0.05, 0.08, 0.11}) {
    SyntheticTable table = far_table({0.1, -2.4, 1.2});
    table.bowls = {{{0, 0, 0}, 0.1, 0.9 * radius, radius}};
    EXPECT_EQ(found_on(table, 1).first, 1U) << radius;
  }
}

TEST(RowSplitting, LongObjectsStayWhole) {
  SyntheticTable box = far_table({1.2, -2.0, 0.9});
  box.boxes = {{{0, 0, 0.06}, {0.1, 0.4, 0.12}}};
  EXPECT_EQ(found_on(box, 1), std::pair(size_t{1}, 1));
  SyntheticTable hidden = far_table({0.1, -2.4, 0.9});
  hidden.boxes = {{{0, 0.05, 0.05}, {0.3, 0.1, 0.1}}, {{0, -0.12, 0.10}, {0.06, 0.06, 0.20}}};
  EXPECT_EQ(found_on(hidden, 1).first, 2U);
}

}  // namespace
}  // namespace loci::perception
