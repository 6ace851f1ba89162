#include "perception/conversions/hypotheses.h"

#include <gtest/gtest.h>

#include <algorithm>
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
    cluster = ReferenceClusterPoints::create(cas);
    cluster.cloud.set(cloud);
    cluster.source.set("test");
    std::vector<int32_t> indices;
    for (int32_t i = 0; i < 400; ++i) indices.push_back(i);  // the upper ten rows
    cluster.indices.get_or_create().indices.set(indices);
  }

  cas::Cas cas{type_system()};
  PointCloud cloud;
  ReferenceClusterPoints cluster;
};

TEST_F(Hypotheses, VolumesHoldThePointsInThem) {
  Isometry3d map_from_camera(Eigen::AngleAxisd(0.7, Vector3d(1, 1, 0).normalized()));
  map_from_camera.translation() = Vector3d(1, 2, 3);
  const std::vector<Vector3d> measured = positions_of(cluster);
  Eigen::AlignedBox3d extent;
  for (const Vector3d& point : measured) extent.extend(point);
  const double rounding = 1e-6;
  Isometry3d middle = map_from_camera;
  middle.translation() = map_from_camera * extent.center();
  const auto box = TFLinkBBoxROI::create(cas);
  box.bbox.get_or_create().pose.set(to(cas, middle));
  box.bbox.get().size.set(to(cas, Vector3d(extent.sizes().array() + rounding)));
  const auto sphere = TFLinkSphereROI::create(cas);
  sphere.center.set(to(cas, Vector3d(middle.translation())));
  sphere.radius.set(extent.sizes().norm() / 2 + rounding);
  for (const TFLinkROI& volume : {TFLinkROI(box.structure()), TFLinkROI(sphere.structure())}) {
    volume.source.set("test");
    const auto made = points_in_volume(volume, cloud, map_from_camera);
    EXPECT_EQ(made.source.get(), "test");
    const auto inside = made.indices.get().indices.to_vector();
    const auto found = std::count_if(inside.begin(), inside.end(), [](int32_t index) { return index < 400; });
    EXPECT_EQ(static_cast<size_t>(found), measured.size());
    EXPECT_LT(inside.size(), 30U * 40U) << "not everything";
  }
}

TEST_F(Hypotheses, RefuseWhatIsNotThere) {
  cluster.indices.get().indices.set({5000});
  EXPECT_THROW(positions_of(cluster), Error);
  EXPECT_THROW(positions_of(StandaloneClusterPoints::create(cas)), Error);
}

}  // namespace
}  // namespace loci::perception::types
