#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "mapping/base/math/random.h"
#include "perception/annotators/description/texture_annotator.h"
#include "perception/annotators/scene_data.h"
#include "perception/conversions/opencv.h"

namespace loci::perception {
namespace {

/// A board of 20 cm, 1 m before the camera, which shows `print` at (60, 40) of the image.
types::Cluster show_board(cas::Cas& cas, const cv::Mat& print) {
  constexpr int kWidth = 320, kHeight = 240;
  constexpr float kFocal = 500;
  const cv::Rect region({60, 40}, print.size());
  const types::SceneCas scene(cas);
  scene.create_scene().map_from_camera.set(
      types::to_stamped(cas, Isometry3d(Eigen::Translation3d(0, 0, 2)), "map", "depth_camera", 0));
  mapping::RgbdCamera camera;
  camera.depth =
      camera.color = {kWidth, kHeight, double(kFocal), double(kFocal), kWidth / 2.0, kHeight / 2.0};
  types::set_cameras(scene, camera);
  cv::Mat points(kHeight, kWidth, CV_32FC3);
  std::vector<int32_t> indices;
  for (int v = 0; v < kHeight; ++v)
    for (int u = 0; u < kWidth; ++u) {
      points.at<cv::Vec3f>(v, u) = {static_cast<float>(u - kWidth / 2) / kFocal,
                                    static_cast<float>(v - kHeight / 2) / kFocal, 1};
      if (region.contains({u, v})) indices.push_back(v * kWidth + u);
    }
  set_cloud_points(scene, points);
  const auto cluster = types::Cluster::create(cas);
  const auto reference = types::ReferenceClusterPoints::create(cas);
  reference.cloud.set(scene.cloud());
  reference.indices.get_or_create().indices.set(indices);
  cluster.hypotheses.push_back(reference);
  const auto roi = types::StandaloneImageROI::create(cas);
  roi.roi.set(types::to(cas, region));
  roi.mask.set(types::to(cas, cv::Mat(print.size(), CV_8U, cv::Scalar(255))));
  roi.image.set(types::to(cas, print));
  cluster.hypotheses.push_back(roi);
  scene.add_cluster(cluster);
  Resources resources;
  Warnings warnings;
  Context context{resources, warnings, 1, {}};
  TextureAnnotator().process(cas, context);
  return cluster;
}

TEST(TextureAnnotation, HasKeyPointsOfAPrintInTheMap) {
  cv::Mat print(100, 100, CV_8UC3, cv::Scalar::all(230));
  Random random(1);
  for (int i = 0; i < 60; ++i) {
    const cv::Scalar color(random.uniform(0, 255), random.uniform(0, 255), random.uniform(0, 255));
    cv::circle(print, cv::Point2d(random.uniform(5, 95), random.uniform(5, 95)), 4, color, cv::FILLED);
  }
  cas::Cas cas(types::type_system());
  const auto texture = show_board(cas, print).annotations.first<types::TextureAnnotation>();
  ASSERT_TRUE(texture);
  const auto positions = texture.positions.get(), diameters = texture.diameters.get();
  EXPECT_GE(diameters.size(), 20U);
  EXPECT_LE(diameters.size(), 110U) << "OpenCV may exceed the number by equal ones";
  EXPECT_EQ(positions.size(), 3 * diameters.size());
  EXPECT_EQ(texture.descriptors.get().size(), 64 * diameters.size());
  for (size_t i = 0; i < diameters.size(); ++i) {
    EXPECT_GE(positions[3 * i], (60 - 160) / 500.0F - 1e-4F);
    EXPECT_LE(positions[3 * i], (160 - 160) / 500.0F + 1e-4F);
    EXPECT_FLOAT_EQ(positions[3 * i + 2], 3);
    EXPECT_GT(diameters[i], 0.002F);
    EXPECT_LT(diameters[i], 0.2F);
  }
}

TEST(TextureAnnotation, OfAPlainObjectIsNone) {
  cas::Cas cas(types::type_system());
  EXPECT_FALSE(show_board(cas, cv::Mat(100, 100, CV_8UC3, cv::Scalar(20, 120, 200)))
                   .annotations.first<types::TextureAnnotation>());
}

}  // namespace
}  // namespace loci::perception
