#include <gmock/gmock.h>

#include <filesystem>
#include <map>

#include "mapping/base/files.h"
#include "mapping/base/math/math.h"
#include "mapping/image/image_io.h"
#include "mapping/simulation/scenario.h"
#include "perception/annotators/segmentation/clustering/object_clusters.h"
#include "perception/annotators/structure/known_structure.h"
#include "perception/annotators/structure/normals.h"
#include "perception/types/geometry.h"
#include "tests/perception/annotators/synthetic_table.h"

namespace loci::perception {
namespace {

using test::SyntheticTable;

struct Found {
  cv::Mat labels;
  std::vector<SupportPlane> supports;
  std::vector<ObjectCluster> clusters;
};

Found find(const SyntheticTable& table, double sigma, const std::optional<Vector3d>& up,
           const ClusterOptions& options = ClusterOptions()) {
  Found found;
  const cv::Mat depth =
      smooth_depth(table.render(sigma, found.labels), table.camera, NormalOptions::for_objects());
  const cv::Mat points = points_from_depth(depth, table.camera);
  const cv::Mat normals = normals_from_depth(depth, table.camera, NormalOptions::for_objects());
  found.supports = find_supports(points, normals, table.camera, up, SupportOptions());
  found.clusters = extract_clusters({points, normals, {}, {}}, table.camera, found.supports, options);
  return found;
}

/// Overlap of a cluster with what is labelled `label`.
double overlap(const Found& found, const ObjectCluster& cluster, int label) {
  int both = 0;
  for (const int pixel : cluster.pixels) both += found.labels.ptr<int>()[pixel] == label ? 1 : 0;
  const int labelled = cv::countNonZero(found.labels == label);
  return static_cast<double>(both) / (static_cast<double>(cluster.pixels.size()) + labelled - both);
}

double best_overlap(const Found& found, int label) {
  double best = 0;
  for (const ObjectCluster& cluster : found.clusters) best = std::max(best, overlap(found, cluster, label));
  return best;
}

SyntheticTable table_with_boxes() {
  SyntheticTable table;
  table.boxes = {{{-0.25, 0.0, 0.05}, {0.12, 0.10, 0.10}},
                 {{0.05, 0.05, 0.06}, {0.10, 0.10, 0.12}},
                 {{0.30, -0.1, 0.04}, {0.08, 0.08, 0.08}}};
  return table;
}

TEST(Supports, TheTableIsFoundWithAndWithoutGravity) {
  const SyntheticTable table = table_with_boxes();
  for (const std::optional<Vector3d>& up : {std::optional<Vector3d>(table.up()), std::optional<Vector3d>()}) {
    const Found found = find(table, 0.1, up);
    ASSERT_EQ(found.supports.size(), 1U);
    EXPECT_GT(found.supports[0].normal.dot(table.up()), std::cos(1.5 * kPi / 180));
    const Vector3d centre = table.map_from_camera * found.supports[0].camera_from_plane.translation();
    EXPECT_NEAR(centre.z(), 0, 0.005);
  }
}

TEST(Supports, APlaneFarBelowTheCameraIsOneWhereItEnds) {
  SyntheticTable table = table_with_boxes();
  table.map_from_camera = mapping::looking_at({0, -1.0, 1.5}, {0, 0, 0});
  EXPECT_EQ(find(table, 0.1, table.up()).supports.size(), 1U);
  // Of three ends the image shows the farthest only.
  table.map_from_camera = mapping::looking_at({0, -0.1, 1.4}, {0, 0.4, 0});
  table.camera = {320, 240, 500, 500, 160, 120};
  EXPECT_EQ(find(table, 0.1, table.up()).supports.size(), 1U);
  table.map_from_camera = mapping::looking_at({0, -1.0, 1.5}, {0, 0, 0});
  // Of a floor no end is seen.
  table.camera = {320, 240, 900, 900, 160, 120};
  EXPECT_TRUE(find(table, 0.1, table.up()).supports.empty());
}

TEST(Supports, ReachAsFarAsTheyAreInViewThoughTheyBeginBehindTheCamera) {
  cas::Cas cas(types::type_system());
  const auto counter = types::PlanarSupport::create(cas);
  counter.outline.set(types::values_from_points(
      {Vector3d(-4, 0, 0.9), Vector3d(4, 0, 0.9), Vector3d(4, 0.6, 0.9), Vector3d(-4, 0.6, 0.9)}));
  const mapping::PinholeCamera camera{320, 240, 290, 290, 160, 120};
  const Isometry3d map_from_camera = mapping::looking_at({0, -0.3, 1.5}, {2, 0.3, 0.9});
  const cv::Mat inside = pixels_over(counter, map_from_camera.inverse(), camera);
  for (const double x : {0.8, 1.5, 2.5, 3.9}) {
    const Vector2d at = camera.project(map_from_camera.inverse() * Vector3d(x, 0.3, 0.9));
    if (!camera.contains(at)) continue;
    EXPECT_EQ(inside.at<unsigned char>(static_cast<int>(at.y()), static_cast<int>(at.x())), 255) << x;
  }
  const Vector2d floor = camera.project(map_from_camera.inverse() * Vector3d(1.5, -0.4, 0.9));
  EXPECT_EQ(inside.at<unsigned char>(static_cast<int>(floor.y()), static_cast<int>(floor.x())), 0);
}

TEST(Clusters, EveryBoxIsOneObjectAndNothingElseIs) {
  const Found found = find(table_with_boxes(), 0.1, table_with_boxes().up());
  EXPECT_EQ(found.clusters.size(), 3U);
  for (int label = 1; label <= 3; ++label) EXPECT_GT(best_overlap(found, label), 0.8) << label;
}

TEST(Clusters, ABookMayHideTheCornerOfTheTableThatItLiesOn) {
  SyntheticTable table;
  table.camera = {320, 240, 220, 220, 160, 120};  // sees the whole table
  table.boxes = {{{-0.49, -0.29, 0.02}, {0.22, 0.22, 0.04}}};
  const Found found = find(table, 0.1, table.up());
  ASSERT_EQ(found.clusters.size(), 1U);
  EXPECT_GT(best_overlap(found, 1), 0.8);
  EXPECT_TRUE(found.clusters[0].at_region_border);
  // What stands beside the table, as high as it is, does not lie on it.
  table.boxes = {{{-0.73, 0.0, -0.02}, {0.22, 0.22, 0.14}}};
  EXPECT_TRUE(find(table, 0.1, table.up()).clusters.empty());
}

TEST(Clusters, AreTheSameOnAnyNumberOfThreads) {
  const SyntheticTable table = table_with_boxes();
  cv::Mat labels;
  const cv::Mat depth = smooth_depth(table.render(0.1, labels), table.camera, NormalOptions::for_objects());
  const cv::Mat points = points_from_depth(depth, table.camera);
  const cv::Mat normals = normals_from_depth(depth, table.camera, NormalOptions::for_objects());
  const auto supports = find_supports(points, normals, table.camera, table.up(), SupportOptions());
  const auto pixels_with = [&](int threads) {
    std::vector<std::vector<int>> pixels;
    for (const ObjectCluster& cluster :
         extract_clusters({points, normals, {}, {}}, table.camera, supports, ClusterOptions(), threads))
      pixels.push_back(cluster.pixels);
    return pixels;
  };
  const auto once = pixels_with(1);
  EXPECT_EQ(once.size(), 3U);
  EXPECT_EQ(once, pixels_with(2));
  EXPECT_EQ(once, pixels_with(5));
}

TEST(PolygonOutline, TellsTheDistanceToTheNearestEdge) {
  const PolygonOutline square({{0, 0}, {2, 0}, {2, 2}, {0, 2}});
  EXPECT_DOUBLE_EQ(square.inside({0.5, 1}), 0.5);
  EXPECT_DOUBLE_EQ(square.inside({1, 1}), 1);
  EXPECT_DOUBLE_EQ(square.inside({2.25, 1}), -0.25);
  EXPECT_LT(PolygonOutline(std::vector<Vector2d>{{0, 0}, {1, 0}}).inside({0, 0}), -1e6);
  const PolygonOutline corner({{0, 0}, {3, 0}, {3, 1}, {1, 1}, {1, 3}, {0, 3}, {0, 0}});
  EXPECT_DOUBLE_EQ(corner.inside({0.5, 2}), 0.5);
  EXPECT_DOUBLE_EQ(corner.inside({2, 2}), -1);
  EXPECT_NEAR(corner.inside({0.7, 0.7}), std::hypot(0.3, 0.3), 1e-12);
  EXPECT_DOUBLE_EQ(corner.inside({-3, 4}), -std::hypot(3, 1));
}

TEST(Clusters, TouchingBoxesAreSplitAtTheirConcaveEdge) {
  SyntheticTable table;
  table.boxes = {{{-0.05, 0.0, 0.09}, {0.10, 0.10, 0.18}}, {{0.06, -0.01, 0.035}, {0.12, 0.12, 0.07}}};
  const Found found = find(table, 0.05, table.up());
  EXPECT_EQ(found.clusters.size(), 2U);
  for (int label = 1; label <= 2; ++label) EXPECT_GT(best_overlap(found, label), 0.75) << label;
}

TEST(Clusters, AStackIsTwoObjectsOneOnTheOther) {
  SyntheticTable table;
  table.boxes = {{{0, 0, 0.04}, {0.20, 0.20, 0.08}}, {{0, 0.02, 0.13}, {0.09, 0.09, 0.10}}};
  const Found found = find(table, 0.05, table.up());
  ASSERT_EQ(found.clusters.size(), 2U);
  const size_t upper = found.clusters[0].top > found.clusters[1].top ? 0 : 1;
  EXPECT_EQ(found.clusters[upper].stands_on, static_cast<int>(1 - upper));
  EXPECT_EQ(found.clusters[1 - upper].stands_on, -1);
}

TEST(Clusters, ABottleKeepsItsNeckAndCap) {
  for (const double neck : {0.013, 0.018}) {
    SyntheticTable table;
    const auto bottle = [&](double x, double y) -> std::vector<test::TableCone> {
      return {{{x, y, 0}, 0.15, 0.036, 0.036},
              {{x, y, 0.15}, 0.05, 0.036, neck},
              {{x, y, 0.20}, 0.04, neck, neck},
              {{x, y, 0.24}, 0.02, neck + 0.003, neck + 0.003}};
    };
    table.rounds = {bottle(-0.2, 0.05), bottle(0.15, -0.1)};
    const Found found = find(table, 0.05, table.up());
    EXPECT_EQ(found.clusters.size(), 2U) << neck;
    for (int label = 1; label <= 2; ++label) EXPECT_GT(best_overlap(found, label), 0.85) << neck;
  }
}

TEST(Clusters, ABentRodIsOneThing) {
  // As bananas lie: an arc that is hollow towards the camera, as thick as high.
  for (const double x : {-0.3, 0.0, 0.25})
    for (const double bend_m : {0.08, 0.1, 0.13}) {
      SyntheticTable table;
      auto& rod = table.rounds.emplace_back();
      for (double angle = -1.0; angle <= 1.0; angle += 0.05) {
        const double radius = 0.019 * (1 - 0.4 * angle * angle);
        const Vector3d foot(x + bend_m * std::sin(angle), 0.25 + bend_m * std::cos(angle), 0);
        rod.push_back({foot, 0.019, radius, radius});
        rod.push_back({foot + Vector3d(0, 0, 0.019), 0.018, radius, 0.35 * radius});
      }
      const Found found = find(table, 0.1, table.up());
      EXPECT_EQ(found.clusters.size(), 1U) << x << " " << bend_m;
      EXPECT_GT(best_overlap(found, 1), 0.7) << x << " " << bend_m;
    }
}

TEST(Clusters, ABowlOfWhichABottleHidesASideIsOneThing) {
  struct Case {
    double aside, radius_low, radius_high;
  };
  for (const auto& [aside, low, high] : {Case{0.03, 0.035, 0.06}, Case{0.03, 0.05, 0.06},
                                         Case{-0.03, 0.02, 0.075}, Case{-0.075, 0.05, 0.075}}) {
    SyntheticTable table;
    table.camera = {640, 480, 585, 585, 320, 240};
    table.rounds = {{{{aside, -0.12, 0}, 0.22, 0.03, 0.03}}};
    table.bowls = {{{0, 0.02, 0}, 0.06, low, high}};
    const Found found = find(table, 0.1, table.up());
    EXPECT_EQ(found.clusters.size(), 2U) << aside << " " << low << " " << high;
    for (int label = 1; label <= 2; ++label) EXPECT_GT(best_overlap(found, label), 0.7) << aside;
  }
}

TEST(Clusters, ASmallBoxInTheMiddleOfALargerOneIsAThingOfItsOwn) {
  SyntheticTable table;
  table.boxes = {{{0, 0, 0.06}, {0.14, 0.10, 0.12}}, {{0, 0, 0.145}, {0.045, 0.045, 0.05}}};
  const Found found = find(table, 0.05, table.up());
  EXPECT_EQ(found.clusters.size(), 2U);
  for (int label = 1; label <= 2; ++label) EXPECT_GT(best_overlap(found, label), 0.7) << label;
}

TEST(Clusters, ABoxHiddenInTheMiddleIsOneObject) {
  SyntheticTable table;
  table.boxes = {{{0, 0.05, 0.04}, {0.24, 0.10, 0.08}}, {{0, -0.08, 0.10}, {0.06, 0.06, 0.20}}};
  const Found found = find(table, 0.05, table.up());
  EXPECT_EQ(found.clusters.size(), 2U);
  EXPECT_GT(best_overlap(found, 1), 0.8);
}

TEST(Clusters, TwoBoxesOfNearlyOneHeightWithAHiddenGapAreTwoObjects) {
  SyntheticTable table;
  table.boxes = {{{-0.0725, 0.05, 0.04}, {0.095, 0.10, 0.08}},
                 {{0.0725, 0.05, 0.0445}, {0.095, 0.10, 0.089}},
                 {{0, -0.08, 0.10}, {0.06, 0.06, 0.20}}};
  const Found found = find(table, 0.05, table.up());
  EXPECT_EQ(found.clusters.size(), 3U);
  for (int label = 1; label <= 3; ++label) EXPECT_GT(best_overlap(found, label), 0.7) << label;
}

TEST(Clusters, EqualCupsBehindEachOtherAreObjectsOfTheirOwn) {
  // Each hides the gap to the next one, which is as high; from nearby the middle one is all that hides it.
  for (const Vector3d& eye : {Vector3d(0.1, -1.2, 0.55), Vector3d(0.02, -0.75, 0.3)}) {
    SyntheticTable table;
    table.camera = {640, 480, 585, 585, 320, 240};
    table.map_from_camera = mapping::looking_at(eye, {0, 0, 0.05});
    for (const double y : {-0.18, -0.05, 0.08}) table.bowls.push_back({{0.02 * y, y, 0}, 0.1, 0.042, 0.042});
    const Found found = find(table, 0.05, table.up());
    EXPECT_EQ(found.clusters.size(), 3U) << eye.y();
    for (int cup = 1; cup <= 3; ++cup) EXPECT_GT(best_overlap(found, cup), 0.75) << eye.y() << " " << cup;
  }
}

TEST(Clusters, ABowlIsOneObjectWithItsInside) {
  for (const double sigma : {0.0, 0.05}) {
    SyntheticTable table;
    table.bowls = {{{-0.15, 0.05, 0}, 0.07, 0.045, 0.085}, {{0.12, -0.1, 0}, 0.10, 0.038, 0.042}};
    const Found found = find(table, sigma, table.up());
    EXPECT_EQ(found.clusters.size(), 2U) << sigma;
    for (int label = 1; label <= 2; ++label) EXPECT_GT(best_overlap(found, label), 0.85) << sigma << label;
  }
}

TEST(Clusters, ABoxAgainstABowlLeavesTheBowlWhole) {
  SyntheticTable table;
  table.boxes = {{{0.05, -0.02, 0.06}, {0.09, 0.07, 0.12}}};
  table.bowls = {{{-0.09, 0.0, 0}, 0.07, 0.05, 0.085}};
  const Found found = find(table, 0.05, table.up());
  EXPECT_EQ(found.clusters.size(), 2U);
  for (int label = 1; label <= 2; ++label) EXPECT_GT(best_overlap(found, label), 0.8) << label;
}

TEST(Clusters, ThingsOnTwoLevelsStandOnTheirOwnSupports) {
  SyntheticTable table;
  // A board of 8 cm takes the right half of the table; it is no object of it.
  table.boxes = {{{0.3, 0.0, 0.04}, {0.58, 0.78, 0.08}},
                 {{-0.2, 0.0, 0.05}, {0.10, 0.08, 0.10}},
                 {{0.25, 0.0, 0.13}, {0.08, 0.08, 0.10}}};
  const Found found = find(table, 0.05, table.up());
  ASSERT_EQ(found.supports.size(), 2U);
  ASSERT_EQ(found.clusters.size(), 2U);
  EXPECT_NE(found.clusters[0].support, found.clusters[1].support);
  for (int label = 2; label <= 3; ++label) EXPECT_GT(best_overlap(found, label), 0.8) << label;
}

TEST(Clusters, WhatTheImageCutsOffSaysSo) {
  SyntheticTable table;
  table.boxes = {{{-0.49, 0.0, 0.05}, {0.12, 0.10, 0.10}}, {{0.05, 0.0, 0.05}, {0.08, 0.08, 0.10}}};
  const Found found = find(table, 0, table.up());
  ASSERT_EQ(found.clusters.size(), 2U);
  for (const ObjectCluster& cluster : found.clusters)
    EXPECT_EQ(cluster.at_image_border, cluster.box.x < 4) << cluster.box.x;
}

/// A tall box before the end of a long one: little of the long one's outline borders on it.
TEST(Clusters, WhatSomethingNearerCoversSaysSo) {
  SyntheticTable table;
  table.boxes = {{{-0.05, 0.1, 0.02}, {0.3, 0.04, 0.04}}, {{0.1, -0.1, 0.1}, {0.08, 0.08, 0.2}}};
  const Found found = find(table, 0, table.up());
  ASSERT_EQ(found.clusters.size(), 2U);
  for (const ObjectCluster& cluster : found.clusters)
    EXPECT_EQ(cluster.partly_hidden, cluster.box.width > cluster.box.height) << cluster.box;
}

TEST(Clusters, AreTheSameEveryTime) {
  const Found one = find(table_with_boxes(), 0.1, table_with_boxes().up());
  const Found two = find(table_with_boxes(), 0.1, table_with_boxes().up());
  ASSERT_EQ(one.clusters.size(), two.clusters.size());
  for (size_t i = 0; i < one.clusters.size(); ++i) EXPECT_EQ(one.clusters[i].pixels, two.clusters[i].pixels);
}

/// From 2.7 m a board that leans back is measured in steps of 2 cm.
TEST(Clusters, AFlatBoardFarAwayIsOneObject) {
  SyntheticTable table;
  table.camera = {640, 480, 585, 585, 320, 240};
  table.map_from_camera.translation() = Vector3d(0, -2.4, 1.0);
  const Vector3d z = (Vector3d(0, 0, 0.05) - table.map_from_camera.translation()).normalized();
  const Vector3d x = z.cross(Vector3d::UnitZ()).normalized();
  table.map_from_camera.linear() << x, z.cross(x), z;
  constexpr int kSlices = 30;
  for (int i = 0; i < kSlices; ++i)  // One board, as slices that lean back by 20 degrees.
    table.boxes.push_back({{0.05, 0.1 + 0.0036 * i, 0.01 * i + 0.005}, {0.4, 0.02, 0.01}});
  Found found = find(table, 0.1, table.up());
  cv::Mat board = found.labels > 0;
  found.labels.setTo(1, board);
  EXPECT_EQ(found.clusters.size(), 1U);
  EXPECT_GT(best_overlap(found, 1), 0.8);
}

TEST(Clusters, WhatHangsInTheAirIsNoObject) {
  SyntheticTable table;
  table.boxes = {{{0.15, 0.1, 0.25}, {0.12, 0.02, 0.12}}, {{-0.15, 0.0, 0.05}, {0.10, 0.08, 0.10}}};
  const Found found = find(table, 0.05, table.up());
  ASSERT_EQ(found.clusters.size(), 1U);
  EXPECT_GT(overlap(found, found.clusters[0], 2), 0.8);
}

TEST(Clusters, WhatIsRoundBelowStandsOnTheTable) {
  SyntheticTable table;  // Nothing lower than the widest place, at 5 cm, is seen.
  table.rounds = {{{{0, 0, 0}, 0.05, 0.015, 0.08}, {{0, 0, 0.05}, 0.05, 0.08, 0.03}}};
  const Found found = find(table, 0.05, table.up());
  ASSERT_EQ(found.clusters.size(), 1U);
  EXPECT_GT(found.clusters[0].bottom, ClusterOptions().resting_m);
  EXPECT_GT(best_overlap(found, 1), 0.8);
}

TEST(Clusters, OfWhatIsLowTheWideIsAnObject) {
  SyntheticTable table;
  table.boxes = {{{-0.15, 0, 0.008}, {0.2, 0.15, 0.016}}, {{0.2, 0, 0.008}, {0.2, 0.02, 0.016}}};
  const Found found = find(table, 0.05, table.up());
  ASSERT_EQ(found.clusters.size(), 1U);
  EXPECT_GT(best_overlap(found, 1), 0.8);
}

TEST(Clusters, WhatHangsBehindAnObjectIsNotHeldByIt) {
  SyntheticTable table;
  table.boxes = {{{0.0, 0.1, 0.22}, {0.3, 0.02, 0.1}}, {{0.0, -0.1, 0.07}, {0.12, 0.02, 0.14}}};
  const Found found = find(table, 0.05, table.up());
  ASSERT_EQ(found.clusters.size(), 1U);
  EXPECT_GT(overlap(found, found.clusters[0], 2), 0.7);
}

/// Of a pillar that is higher than objects may be, only the lower part is a candidate.
TEST(Clusters, APieceOfWhatGoesOnIsNoObject) {
  SyntheticTable table;
  table.boxes = {{{0.15, 0.2, 0.2}, {0.15, 0.04, 0.4}}, {{-0.15, 0.0, 0.05}, {0.10, 0.08, 0.10}}};
  ClusterOptions options;
  options.max_height_m = 0.15;
  const Found found = find(table, 0.05, table.up(), options);
  ASSERT_EQ(found.clusters.size(), 1U);
  EXPECT_GT(overlap(found, found.clusters[0], 2), 0.8);
}

/// A poster on a wall of the map is a part of the wall; a board that stands before it is an object.
TEST(Clusters, WhatIsFlushWithTheMapIsNoObject) {
  SyntheticTable table;
  table.boxes = {{{0.2, 0.268, 0.1}, {0.2, 0.02, 0.2}}, {{-0.2, 0.2, 0.1}, {0.2, 0.02, 0.2}}};
  SyntheticTable map = table;
  map.boxes = {{{0, 0.30, 0.5}, {2, 0.02, 1}}};
  Found found;
  const cv::Mat depth =
      smooth_depth(table.render(0.05, found.labels), table.camera, NormalOptions::for_objects());
  cv::Mat ignored;
  const ClusterImages images{points_from_depth(depth, table.camera),
                             normals_from_depth(depth, table.camera, NormalOptions::for_objects()),
                             {},
                             map.render(0, ignored)};
  found.supports = find_supports(images.points, images.normals, table.camera, table.up(), SupportOptions());
  found.clusters = extract_clusters(images, table.camera, found.supports, ClusterOptions());
  ASSERT_EQ(found.clusters.size(), 1U);
  EXPECT_GT(overlap(found, found.clusters[0], 2), 0.8);
}

/// The far side of a bowl comes so near to the wall behind it that the map explains it, and the near side
/// goes on in it.
TEST(Clusters, WhatStandsBeforeAWallOfTheMapIsNoPieceOfIt) {
  SyntheticTable table;
  table.map_from_camera = mapping::looking_at({0, -0.7, 1.0}, {0, 0.1, 0.05});
  table.boxes = {{{0, 0.35, 0.5}, {2, 0.02, 1}}};
  SyntheticTable map = table;
  table.bowls = {{{0, 0.25, 0}, 0.06, 0.03, 0.078}};
  Found found;
  const cv::Mat depth =
      smooth_depth(table.render(0.05, found.labels), table.camera, NormalOptions::for_objects());
  cv::Mat ignored;
  const cv::Mat map_depth = map.render(0, ignored);
  cv::Mat region;
  cv::Mat((map_depth - depth > 0.05) | (ignored == 0)).convertTo(region, CV_16U, 1 / 255.0);
  const ClusterImages images{points_from_depth(depth, table.camera),
                             normals_from_depth(depth, table.camera, NormalOptions::for_objects()), region,
                             map_depth};
  found.supports = find_supports(images.points, images.normals, table.camera, table.up(), SupportOptions());
  ASSERT_FALSE(found.supports.empty());
  for (SupportPlane& support : found.supports) support.region = 1;
  found.clusters = extract_clusters(images, table.camera, found.supports, ClusterOptions());
  EXPECT_GT(best_overlap(found, 2), 0.5);
}

TEST(Clusters, WhatStandsOutClearlyNeedsFewPixels) {
  SyntheticTable table;
  table.boxes = {{{0.1, 0.2, 0.02}, {0.03, 0.03, 0.04}}};
  const Found found = find(table, 0.05, table.up());
  ASSERT_EQ(found.clusters.size(), 1U);
  ClusterOptions options;
  EXPECT_LT(found.clusters[0].pixels.size(), static_cast<size_t>(options.min_points));
  options.min_clear_points = options.min_points;  // as in a video
  EXPECT_TRUE(find(table, 0.05, table.up(), options).clusters.empty());
}

/// An apple that lies before a pot stays apart from it.
TEST(Clusters, WhatHasAnotherColourIsNoPartOfWhatItTouches) {
  SyntheticTable table;
  table.camera = {640, 480, 585, 585, 320, 240};
  table.boxes = {{{-0.125, 0.02, 0.085}, {0.06, 0.03, 0.02}}};
  table.bowls = {{{0, 0.05, 0}, 0.11, 0.1, 0.1}};
  table.rounds = {{{{0.06, -0.075, 0}, 0.035, 0.02, 0.036}, {{0.06, -0.075, 0.035}, 0.035, 0.036, 0.015}}};
  Found found;
  const cv::Mat depth =
      smooth_depth(table.render(0.1, found.labels), table.camera, NormalOptions::for_objects());
  ClusterImages images{points_from_depth(depth, table.camera),
                       normals_from_depth(depth, table.camera, NormalOptions::for_objects()),
                       {},
                       {}};
  images.color = cv::Mat(depth.size(), CV_8UC3, cv::Scalar(70, 120, 170));
  images.color.setTo(cv::Scalar(30, 30, 30), found.labels == 2);
  images.color_camera = table.camera;
  found.supports = find_supports(images.points, images.normals, table.camera, table.up(), SupportOptions());
  found.clusters = extract_clusters(images, table.camera, found.supports, ClusterOptions());
  EXPECT_EQ(found.clusters.size(), 2U);
  EXPECT_GT(best_overlap(found, 2), 0.8);
}

/// Maps have the box of a drawer by assumption: its boards are seen beside where they are in the map. What
/// is thick, and what stands apart from the sides, is an object.
TEST(Clusters, AnUprightBoardAlongTheSideOfADrawerIsItsOwn) {
  SyntheticTable table;
  table.boxes = {{{0, 0.36, 0.05}, {0.5, 0.012, 0.1}},
                 {{0.2, 0.1, 0.05}, {0.3, 0.012, 0.1}},
                 {{-0.2, 0.1, 0.05}, {0.1, 0.1, 0.1}}};
  Found found = find(table, 0.05, table.up());
  ASSERT_EQ(found.clusters.size(), 3U);
  SupportPlane& drawer = found.supports.at(0);
  drawer.in_drawer = true;
  drawer.outline.clear();
  for (const auto& [x, y] : {std::pair(-0.6, -0.4), {0.6, -0.4}, {0.6, 0.4}, {-0.6, 0.4}})
    drawer.outline.push_back(drawer.in_plane(table.map_from_camera.inverse() * Vector3d(x, y, 0)).head<2>());
  const cv::Mat depth =
      smooth_depth(table.render(0.05, found.labels), table.camera, NormalOptions::for_objects());
  found.clusters = extract_clusters({points_from_depth(depth, table.camera),
                                     normals_from_depth(depth, table.camera, NormalOptions::for_objects()),
                                     {},
                                     {}},
                                    table.camera, {drawer}, ClusterOptions());
  EXPECT_EQ(found.clusters.size(), 2U);
  EXPECT_LT(best_overlap(found, 1), 0.1);
}

/// The labelled scenes of the Object Segmentation Database: label / 10 is the object, from 2 on.
TEST(Clusters, MatchTheLabelledTableScenes) {
  const std::filesystem::path root = std::filesystem::path(LOCI_SHARED_DIR) / "data";
  if (!std::filesystem::exists(root / "osd_tabletop")) GTEST_SKIP() << "needs data/osd_tabletop";
  const mapping::PinholeCamera camera{640, 480, 525, 525, 319.5, 239.5};
  double sum = 0;
  int objects = 0;
  for (const char* name : {"osd_tabletop/learn08", "osd_tabletop/learn21", "osd_tabletop/learn29",
                           "osd_changes/learn36", "osd_changes/learn41"}) {
    const cv::Mat raw = mapping::read_uint16(root / (std::string(name) + "_depth.png"));
    cv::Mat depth;
    raw.convertTo(depth, CV_32F, 0.001);
    depth.setTo(std::numeric_limits<float>::quiet_NaN(), raw == 0);
    const std::string bytes = read_file(root / (std::string(name) + "_label.png"));
    const cv::Mat labels = mapping::decode_image({bytes.begin(), bytes.end()}, name);
    const cv::Mat smooth = smooth_depth(depth, camera, NormalOptions::for_objects());
    const cv::Mat points = points_from_depth(smooth, camera);
    const cv::Mat normals = normals_from_depth(smooth, camera, NormalOptions::for_objects());
    const auto clusters = extract_clusters({points, normals, {}, {}}, camera,
                                           find_supports(points, normals, camera, std::nullopt, {}), {});
    std::map<int, int> sizes;
    for (size_t i = 0; i < labels.total(); ++i) ++sizes[labels.ptr<unsigned char>()[i] / 10];
    for (const auto& [object, size] : sizes) {
      if (object < 2) continue;
      double best = 0;
      for (const ObjectCluster& cluster : clusters) {
        int both = 0;
        for (const int pixel : cluster.pixels)
          both += labels.ptr<unsigned char>()[pixel] / 10 == object ? 1 : 0;
        best = std::max(
            best, static_cast<double>(both) / (size + static_cast<double>(cluster.pixels.size()) - both));
      }
      sum += best;
      ++objects;
    }
  }
  EXPECT_GT(sum / objects, 0.9);
}

/// A table, and a wall behind it, as a map.
std::shared_ptr<KnownMap> table_map(double height_error, Warnings& warnings) {
  mapping::World world;
  world.name = "kitchen";
  world.root = "map";
  world.links.push_back({"map", {}, {}, {}});
  const auto add = [&](const std::string& name, const Vector3d& centre, const Vector3d& size) {
    mapping::Link link;
    link.name = name;
    mapping::Visual visual;
    visual.geometry = mapping::Box{size};
    visual.link_from_visual.translation() = Vector3d(0, 0, -size.z() / 2);
    link.visuals.push_back(visual);
    mapping::Joint joint;
    joint.name = name + "_joint";
    joint.parent = "map";
    joint.child = name;
    joint.parent_from_joint.translation() = centre + Vector3d(0, 0, size.z() / 2);
    world.links.push_back(link);
    world.joints.push_back(joint);
  };
  add("table_1", {0, 0, height_error - 0.02}, {1.2, 0.8, 0.04});
  add("wall_north", {0, 0.25, 0.5}, {2, 0.02, 2});
  return KnownMap::make(std::move(world), {}, {}, warnings);
}

TEST(KnownStructure, TheSupportStaysAndTheWallGoesWhateverTheMapsSmallErrors) {
  for (const double error : {-0.02, 0.0, 0.02}) {
    SyntheticTable table = table_with_boxes();
    table.boxes.push_back({{0, 0.25, 0.5}, {2, 0.02, 1}});  // The wall.
    cv::Mat labels;
    const cv::Mat points = points_from_depth(table.render(0, labels), table.camera);
    Warnings warnings;
    const auto map = table_map(error, warnings);
    const auto surfaces = map->support_surfaces({"table*"});
    ASSERT_EQ(surfaces.size(), 1U);
    EXPECT_EQ(surfaces[0].class_name, "table");
    const KnownStructure known = find_known_structure(points, {}, table.camera, table.map_from_camera, *map,
                                                      surfaces, {}, KnownStructureOptions(), 1);
    int wall_left = 0;
    int boxes_lost = 0;
    int table_lost = 0;
    for (size_t i = 0; i < labels.total(); ++i) {
      const bool kept = known.region.ptr<uint16_t>()[i] > 0;
      const int label = labels.ptr<int>()[i];
      const double z = (table.map_from_camera * Vector3d(static_cast<double>(points.ptr<cv::Vec3f>()[i][0]),
                                                         static_cast<double>(points.ptr<cv::Vec3f>()[i][1]),
                                                         static_cast<double>(points.ptr<cv::Vec3f>()[i][2])))
                           .z();
      wall_left += label == 4 && kept && z > 0.06 ? 1 : 0;
      boxes_lost += label >= 1 && label <= 3 && !kept ? 1 : 0;
      table_lost += label == 0 && !kept ? 1 : 0;
    }
    EXPECT_EQ(wall_left, 0) << error;
    EXPECT_EQ(boxes_lost, 0) << error;
    const int bare_wall = cv::countNonZero((labels == 4) & (known.bare != 0) & (known.region == 0));
    EXPECT_LT(bare_wall, 0.02 * cv::countNonZero(labels == 4)) << error << ": objects do not stand on a wall";
    EXPECT_LT(cv::countNonZero((labels == 0) & (known.bare == 0)), 0.05 * cv::countNonZero(labels == 0))
        << error;
    // At the foot of the wall a line of the table may go with it.
    EXPECT_LT(table_lost, 0.03 * cv::countNonZero(labels == 0)) << error;
  }
}

/// A wall that the camera measures a little before where the map has it, in a part of the image.
TEST(KnownStructure, WhatContinuesAKnownWallGoesWithIt) {
  SyntheticTable table = table_with_boxes();
  table.boxes.push_back({{-0.5, 0.25, 0.5}, {1, 0.02, 1}});
  table.boxes.push_back({{0.5, 0.223, 0.5}, {1, 0.02, 1}});
  table.boxes.push_back({{-0.1, 0.16, 0.1}, {0.1, 0.02, 0.2}});  // Stands before it.
  cv::Mat labels;
  const cv::Mat depth = table.render(0, labels);
  const cv::Mat points = points_from_depth(depth, table.camera);
  const cv::Mat normals = normals_from_depth(depth, table.camera, NormalOptions::for_objects());
  Warnings warnings;
  const auto map = table_map(0, warnings);
  const auto surfaces = map->support_surfaces({"table*"});
  const auto kept = [&](const cv::Mat& used_normals, int label) {
    const KnownStructure known =
        find_known_structure(points, used_normals, table.camera, table.map_from_camera, *map, surfaces, {},
                             KnownStructureOptions(), 1);
    return cv::countNonZero((labels == label) & (known.region > 0)) /
           static_cast<double>(cv::countNonZero(labels == label));
  };
  EXPECT_GT(kept({}, 5), 0.5);
  EXPECT_LT(kept(normals, 5), 0.1);
  EXPECT_GT(kept(normals, 6), 0.9);
  for (int box = 1; box <= 3; ++box) EXPECT_GT(kept(normals, box), 0.99);
}

TEST(KnownMap, ClassesComeFromNamesWithoutASidecar) {
  Warnings warnings;
  const auto map = table_map(0, warnings);
  EXPECT_EQ(map->class_of("drawer_3_bottom"), "drawer_bottom");
  EXPECT_EQ(map->class_of("counter_1"), "counter");
}

}  // namespace
}  // namespace loci::perception
