#include "perception/conversions/hypotheses.h"
#include "mapping/base/math/math.h"

#include <gtest/gtest.h>

#include <limits>

#include "perception/conversions/pcl.h"

namespace loci::perception::types {
namespace {

/// A board of 40 x 30 points, 5 mm apart, 1 m before the camera; every tenth point has no measurement.
class Hypotheses : public testing::Test {
 protected:
  Hypotheses() {
    const auto points = std::make_shared<pcl::PointCloud<pcl::PointXYZ>>();
    const float none = std::numeric_limits<float>::quiet_NaN();
    for (int v = 0; v < 30; ++v)
      for (int u = 0; u < 40; ++u)
        points->push_back((u + v) % 10 == 0 ? pcl::PointXYZ(none, none, none)
                                            : pcl::PointXYZ(0.005F * static_cast<float>(u - 20),
                                                            0.005F * static_cast<float>(v - 15), 1));
    cloud = to(cas, points);
    image = to(cas, cv::Mat(camera.height, camera.width, CV_8UC3, cv::Scalar(1, 2, 3)));
    cluster = ReferenceClusterPoints::create(cas);
    cluster.cloud.set(cloud);
    cluster.source.set("test");
    std::vector<int32_t> indices;
    for (int32_t i = 0; i < 400; ++i) indices.push_back(i);  // the upper ten rows
    cluster.indices.get_or_create().indices.set(indices);
  }
  static std::vector<int32_t> indices_of(const ReferenceClusterPoints& points) {
    return points.indices.get().indices.to_vector();
  }

  cas::Cas cas{type_system()};
  mapping::PinholeCamera camera;
  Isometry3d same = Isometry3d::Identity();
  PointCloud cloud;
  Mat image;
  ReferenceClusterPoints cluster;
};

TEST_F(Hypotheses, PointsGoToTheImageAndBack) {
  const auto roi = image_roi(cluster, image, camera, same, 0);
  ASSERT_TRUE(roi);
  EXPECT_EQ(roi->source.get(), "test");
  const auto back = points_in_image(*roi, cloud, camera, same);
  std::vector<int32_t> measured;
  for (int32_t i = 0; i < 400; ++i)
    if ((i % 40 + i / 40) % 10 != 0) measured.push_back(i);
  EXPECT_EQ(indices_of(back), measured);
}

TEST_F(Hypotheses, TheRegionIsWhereThePointsProject) {
  const auto roi = image_roi(cluster, image, camera, same, 2);
  const cv::Rect region = from<cv::Rect>(roi->roi.get());
  EXPECT_NEAR(region.x, camera.cx - 0.1 * camera.fx, 3);
  EXPECT_NEAR(region.y, camera.cy - 0.075 * camera.fy, 3);
  EXPECT_NEAR(region.width, 39 * 0.005 * camera.fx, 6);
  const StandaloneImageROI alone = standalone(*roi);
  EXPECT_EQ(from<cv::Mat>(alone.image.get()).size(), region.size());
  EXPECT_EQ(from<cv::Mat>(alone.mask.get()).size(), region.size());
}

TEST_F(Hypotheses, PointsBehindTheCameraHaveNoRegion) {
  Isometry3d turned(Eigen::AngleAxisd(kPi, Vector3d::UnitX()));
  EXPECT_FALSE(image_roi(cluster, image, camera, turned));
}

TEST_F(Hypotheses, VolumesHoldThePointsThatTheyWereMadeFrom) {
  Isometry3d map_from_camera(Eigen::AngleAxisd(0.7, Vector3d(1, 1, 0).normalized()));
  map_from_camera.translation() = Vector3d(1, 2, 3);
  const size_t measured = positions_of(cluster).size();
  const auto box = bounding_box(cluster, "map", map_from_camera);
  const auto sphere = bounding_sphere(cluster, "map", map_from_camera);
  const double rounding = 1e-6;
  const Vector3d size = from<Vector3d>(box.bbox.get().size.get());
  box.bbox.get().size.set(to(cas, Vector3d(size.array() + rounding)));
  sphere.radius.set(sphere.radius.get() + rounding);
  for (const TFLinkROI& volume : {TFLinkROI(box.structure()), TFLinkROI(sphere.structure())}) {
    EXPECT_EQ(volume.tf_frame.get(), "map");
    const auto inside = indices_of(points_in_volume(volume, cloud, map_from_camera));
    size_t found = 0;
    for (const int32_t index : inside) found += index < 400 ? 1U : 0U;
    EXPECT_EQ(found, measured);
    EXPECT_LT(inside.size(), 30U * 40U) << "not everything";
  }
}

TEST_F(Hypotheses, AreTheSameInAColourCameraOfAnotherSizeAndPlace) {
  // A finer camera, 5 cm beside the depth camera and turned by 4 degrees.
  const mapping::PinholeCamera color{1280, 960, 1100, 1080, 650, 470};
  Isometry3d color_from_depth(Eigen::AngleAxisd(4 * kPi / 180, Vector3d::UnitY()));
  color_from_depth.translation() = Vector3d(0.05, -0.01, 0.003);
  const Mat color_image = to(cas, cv::Mat(color.height, color.width, CV_8UC3, cv::Scalar(4, 5, 6)));
  const auto roi = image_roi(cluster, color_image, color, color_from_depth, 4);
  ASSERT_TRUE(roi);
  const cv::Rect region = from<cv::Rect>(roi->roi.get());
  for (const Vector3d& point : positions_of(cluster)) {
    const Vector2d pixel = color.project(color_from_depth * point);
    EXPECT_TRUE(region.contains(cv::Point(cvRound(pixel.x()), cvRound(pixel.y()))));
  }
  // Back in the depth camera it is the cluster again, but for its border.
  const auto back = indices_of(points_in_image(*roi, cloud, color, color_from_depth));
  const auto there = std::count_if(back.begin(), back.end(), [](int32_t i) { return i < 400; });
  EXPECT_EQ(static_cast<size_t>(there), positions_of(cluster).size());
  EXPECT_LE(back.size() - static_cast<size_t>(there), 40U) << "one row more, at most";
}

TEST_F(Hypotheses, PointsOfTheirOwnAreFoundAgainInTheScene) {
  const StandaloneClusterPoints alone = standalone(cluster);
  EXPECT_EQ(alone.source.get(), "test");
  EXPECT_EQ(positions_of(alone), positions_of(cluster));
  EXPECT_EQ(alone.cloud.get().width.get(), static_cast<int64_t>(positions_of(cluster).size()));
  std::vector<int32_t> measured;
  for (int32_t i = 0; i < 400; ++i)
    if ((i % 40 + i / 40) % 10 != 0) measured.push_back(i);
  EXPECT_EQ(indices_of(within(alone, cloud, same, 0.002)), measured);
  Isometry3d away = same;
  away.translation().z() = 0.01;
  EXPECT_TRUE(indices_of(within(alone, cloud, away, 0.005)).empty());
}

TEST_F(Hypotheses, ImagesOfTheirOwnAreRegionsOfTheSceneAgain) {
  const auto roi = image_roi(cluster, image, camera, same, 1);
  const ReferenceImageROI back = within(standalone(*roi), image);
  EXPECT_EQ(from<cv::Rect>(back.roi.get()), from<cv::Rect>(roi->roi.get()));
  EXPECT_EQ(indices_of(points_in_image(back, cloud, camera, same)),
            indices_of(points_in_image(*roi, cloud, camera, same)));
  EXPECT_THROW(within(standalone(*roi), to(cas, cv::Mat(20, 20, CV_8UC3))), Error);
}

TEST_F(Hypotheses, VolumesCoverThePixelsOfWhatIsInThem) {
  Isometry3d map_from_camera(Eigen::AngleAxisd(0.7, Vector3d(1, 1, 0).normalized()));
  map_from_camera.translation() = Vector3d(1, 2, 3);
  const auto points = image_roi(cluster, image, camera, same, 0);
  const cv::Rect tight = from<cv::Rect>(points->roi.get());
  for (const TFLinkROI& volume : {TFLinkROI(bounding_box(cluster, "map", map_from_camera).structure()),
                                  TFLinkROI(bounding_sphere(cluster, "map", map_from_camera).structure())}) {
    const auto roi = image_roi(volume, image, camera, map_from_camera.inverse());
    ASSERT_TRUE(roi);
    const cv::Rect region = from<cv::Rect>(roi->roi.get());
    EXPECT_EQ(region & tight, tight);
    EXPECT_LT(region.area(), 8 * tight.area());
    const cv::Mat1b mask = from<cv::Mat_<uint8_t>>(roi->mask.get());
    const cv::Mat1b inner = from<cv::Mat_<uint8_t>>(points->mask.get());
    EXPECT_EQ(cv::countNonZero(inner & ~mask(tight - region.tl())), 0);
    // Behind the camera there is nothing to be seen of it.
    Isometry3d turned(Eigen::AngleAxisd(kPi, Vector3d::UnitX()));
    EXPECT_FALSE(image_roi(volume, image, camera, turned * map_from_camera.inverse()));
  }
}

TEST_F(Hypotheses, AVolumeAroundTheCameraCoversTheImage) {
  const auto sphere = TFLinkSphereROI::create(cas);
  sphere.center.set(to(cas, Vector3d(0, 0, 0)));
  sphere.radius.set(1);
  const auto box = TFLinkBBoxROI::create(cas);
  box.bbox.get_or_create().pose.set(to(cas, same));
  box.bbox.get().size.set(to(cas, Vector3d(2, 2, 2)));
  for (const TFLinkROI& volume : {TFLinkROI(sphere.structure()), TFLinkROI(box.structure())}) {
    const auto roi = image_roi(volume, image, camera, same);
    ASSERT_TRUE(roi);
    EXPECT_EQ(from<cv::Rect>(roi->roi.get()), cv::Rect(0, 0, camera.width, camera.height));
    EXPECT_EQ(cv::countNonZero(from<cv::Mat>(roi->mask.get())), camera.width * camera.height);
  }
}

TEST_F(Hypotheses, VolumesGoToOtherFramesAndShapes) {
  Isometry3d table_from_map(Eigen::AngleAxisd(kPi / 6, Vector3d::UnitZ()));
  table_from_map.translation() = Vector3d(1, 0, -1);
  const auto box = TFLinkBBoxROI::create(cas);
  box.tf_frame.set("map");
  Isometry3d pose = Isometry3d::Identity();
  pose.translation() = Vector3d(0.5, 0.5, 1.5);
  box.bbox.get_or_create().pose.set(to(cas, pose));
  box.bbox.get().size.set(to(cas, Vector3d(0.4, 0.2, 0.1)));
  const TFLinkBBoxROI there = bounding_box(box, "table", table_from_map);
  EXPECT_EQ(there.tf_frame.get(), "table");
  const Vector3d size = from<Vector3d>(there.bbox.get().size.get());
  const double c = std::cos(kPi / 6), s = 0.5;
  EXPECT_TRUE(size.isApprox(Vector3d(0.4 * c + 0.2 * s, 0.4 * s + 0.2 * c, 0.1), 1e-9)) << size.transpose();
  const TFLinkSphereROI ball = bounding_sphere(box, "table", table_from_map);
  EXPECT_NEAR(ball.radius.get(), Vector3d(0.2, 0.1, 0.05).norm(), 1e-12);
  EXPECT_TRUE(from<Vector3d>(ball.center.get()).isApprox(table_from_map * pose.translation(), 1e-9));
  const TFLinkBBoxROI around = bounding_box(ball, "table", same);
  EXPECT_NEAR(from<Vector3d>(around.bbox.get().size.get()).x(), 2 * ball.radius.get(), 1e-12);
}

TEST_F(Hypotheses, RefuseWhatIsNotThere) {
  cluster.indices.get().indices.set({5000});
  EXPECT_THROW(positions_of(cluster), Error);
  cluster.indices.get().indices.set(std::vector<int32_t>());
  EXPECT_THROW(bounding_box(cluster, "map", same), Error);
  EXPECT_THROW(positions_of(StandaloneClusterPoints::create(cas)), Error);
  const auto roi = ReferenceImageROI::create(cas);
  roi.image.set(image);
  roi.roi.set(to(cas, cv::Rect(630, 0, 20, 20)));
  EXPECT_THROW(standalone(roi), Error);
}

}  // namespace
}  // namespace loci::perception::types
