#include "perception/conversions/hypotheses.h"

#include <gtest/gtest.h>

#include <limits>
#include <numbers>

#include "perception/conversions/pcl.h"

namespace loci::types {
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
  PinholeCamera camera;
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
  Isometry3d turned(Eigen::AngleAxisd(std::numbers::pi, Vector3d::UnitX()));
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
}  // namespace loci::types
