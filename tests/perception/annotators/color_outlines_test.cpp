#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "perception/annotators/segmentation/clustering/color_outlines.h"
#include "perception/annotators/segmentation/clustering/object_clusters.h"
#include "perception/annotators/structure/normals.h"
#include "tests/perception/annotators/synthetic_table.h"

namespace loci::perception {
namespace {

const cv::Vec3b kWood(90, 120, 160), kSteel(190, 190, 190), kBlack(30, 30, 30);

/// Boxes on a wooden table before a Kinect, each of its own colour.
struct Scene {
  cv::Mat labels;  ///< 0 = table, box n has n + 1
  test::SyntheticTable table;
  ClusterImages images;
  std::vector<SupportPlane> supports;
  std::vector<ObjectCluster> clusters;

  Scene(const std::vector<test::TableBox>& boxes, const std::vector<cv::Vec3b>& colors) {
    table.camera = {640, 480, 585, 585, 320, 240};
    table.boxes = boxes;
    const cv::Mat depth =
        smooth_depth(table.render(0.05, labels), table.camera, NormalOptions::for_objects());
    images.points = points_from_depth(depth, table.camera);
    images.normals = normals_from_depth(depth, table.camera, NormalOptions::for_objects());
    images.color = cv::Mat(depth.size(), CV_8UC3, cv::Scalar(kWood));
    for (size_t i = 0; i < colors.size(); ++i)
      images.color.setTo(cv::Scalar(colors[i]), labels == static_cast<int>(i) + 1);
    images.color_camera = table.camera;
    supports = find_supports(images.points, images.normals, table.camera, table.up(), SupportOptions());
    clusters = extract_clusters(images, table.camera, supports, ClusterOptions());
  }

  /// Overlap of a cluster with all boxes together.
  double overlap(const ObjectCluster& cluster) const {
    int both = 0;
    for (const int pixel : cluster.pixels) both += labels.ptr<int>()[pixel] > 0 ? 1 : 0;
    return both / (static_cast<double>(cluster.pixels.size()) + cv::countNonZero(labels > 0) - both);
  }
};

TEST(ColorOutlines, AKnifeIsOneObjectAlthoughItIsLowAndOfTwoColours) {
  const Scene scene({{{-0.06, 0, 0.005}, {0.1, 0.018, 0.01}}, {{0.06, 0, 0.003}, {0.14, 0.03, 0.006}}},
                    {kBlack, kSteel});
  ASSERT_EQ(scene.clusters.size(), 1U);
  EXPECT_GT(scene.overlap(scene.clusters[0]), 0.75);
}

TEST(ColorOutlines, WhatIsPaintedOnTheTableDoesNotRise) {
  const Scene scene({{{0, 0, 0.00005}, {0.2, 0.03, 0.0001}}}, {kBlack});
  EXPECT_TRUE(scene.clusters.empty());
}

TEST(ColorOutlines, ATrayHasItsBottom) {
  const cv::Vec3b blue(150, 60, 30);
  const Scene scene({{{0, 0, 0.003}, {0.4, 0.28, 0.006}},
                     {{-0.195, 0, 0.015}, {0.01, 0.28, 0.03}},
                     {{0.195, 0, 0.015}, {0.01, 0.28, 0.03}},
                     {{0, -0.135, 0.015}, {0.4, 0.01, 0.03}},
                     {{0, 0.135, 0.015}, {0.4, 0.01, 0.03}}},
                    {blue, blue, blue, blue, blue});
  ASSERT_EQ(scene.clusters.size(), 1U);
  EXPECT_GT(scene.overlap(scene.clusters[0]), 0.9);
}

TEST(ColorOutlines, TwoKnivesBesideEachOtherStayTwo) {
  const Scene scene({{{0, 0, 0.004}, {0.2, 0.02, 0.008}}, {{0, 0.05, 0.004}, {0.2, 0.02, 0.008}}},
                    {kSteel, kSteel});
  EXPECT_EQ(scene.clusters.size(), 2U);
}

TEST(ColorOutlines, AnOutlineThatIsOfClustersThatReachBeyondItIsNoObject) {
  const Scene scene({{{0, 0, 0.004}, {0.2, 0.03, 0.008}}}, {kSteel});
  cv::Mat around, shows(scene.labels.size(), CV_8U, cv::Scalar(static_cast<double>(Shows::support)));
  cv::dilate(scene.labels > 0, around, cv::Mat::ones(25, 25, CV_8U));
  shows.setTo(static_cast<double>(Shows::candidate), around);
  std::vector<ObjectCluster> halves(2);
  for (int v = 0; v < around.rows; ++v)
    for (int u = 0; u < around.cols; ++u)
      if (around.at<uint8_t>(v, u)) halves[u < around.cols / 2 ? 0 : 1].pixels.push_back(v * around.cols + u);
  for (ObjectCluster& half : halves) half.top = 0.008;
  const std::vector<int> pixels = halves[0].pixels;
  join_by_color_outline(halves, scene.images, scene.table.camera, SupportGround(scene.supports.at(0)), 0,
                        shows, ClusterOptions());
  ASSERT_EQ(halves.size(), 2U);
  EXPECT_EQ(halves[0].pixels, pixels);
}

}  // namespace
}  // namespace loci::perception
