#include <gtest/gtest.h>

#include "mapping/base/config.h"
#include "perception/annotators/scene_data.h"
#include "perception/annotators/segmentation/asserted_volumes.h"
#include "perception/conversions/opencv.h"

namespace loci::perception {
namespace {

/// A plane at z = 1 m with a raised square, before a camera that is the map frame's origin.
class Volumes : public ::testing::Test {
 protected:
  Volumes() : cas_(types::type_system()), scene_(cas_) {
    const types::Scene scene = scene_.create_scene();
    scene.map_from_camera.set(
        types::to_stamped(cas_, Isometry3d(Isometry3d::Identity()), "map", "depth_camera", 0));
    cv::Mat points(40, 40, CV_32FC3);
    for (int v = 0; v < 40; ++v)
      for (int u = 0; u < 40; ++u)
        points.at<cv::Vec3f>(v, u) = {0.01f * static_cast<float>(u), 0.01f * static_cast<float>(v),
                                      u >= 10 && u < 20 && v >= 10 && v < 20 ? 0.9f : 1.0f};
    set_cloud_points(scene_, points);
    const auto support = types::PlanarSupport::create(cas_);
    support.normal.set(types::to(cas_, Vector3d(0, 0, -1)));
    support.offset.set(-1);
    scene_.add_support(support);
  }

  void run(const std::string& volume) {
    AssertedVolumes annotator;
    OptionTable table;
    annotator.declare(table);
    table.read(Config::parse("volumes: ['" + volume + "']", "test"));
    Resources resources;
    Warnings warnings;
    Context context{resources, warnings, 1, {}};
    annotator.start(context);
    annotator.process(cas_, context);
  }

  cas::Cas cas_;
  types::SceneCas scene_;
};

TEST_F(Volumes, WhatIsInsideAboveTheSupportBecomesACluster) {
  run("map 0.145 0.145 0.95 0.3 0.3 0.2");
  ASSERT_EQ(scene_.clusters().size(), 1U);
  EXPECT_EQ(cluster_indices(scene_.clusters()[0]).size(), 100U);
  const auto box = scene_.clusters()[0].hypotheses.first<types::TFLinkBBoxROI>();
  ASSERT_TRUE(box);
  EXPECT_EQ(box.tf_frame.get(), "map");
}

TEST_F(Volumes, AVolumeAroundAKnownClusterIsOneMoreHypothesisOfIt) {
  run("map 0.145 0.145 0.95 0.3 0.3 0.2");
  run("map 0.145 0.145 0.9 0.05");
  ASSERT_EQ(scene_.clusters().size(), 1U);
  EXPECT_TRUE(scene_.clusters()[0].hypotheses.first<types::TFLinkSphereROI>());
}

TEST_F(Volumes, WhereNothingIsSeenOrTheFrameIsUnknownThereIsNoCluster) {
  run("map 0.3 0.3 0.9 0.05");
  run("drawer_7_bottom 0 0 0 5");
  EXPECT_TRUE(scene_.clusters().empty());
}

TEST(AssertedVolume, RefusesWhatIsNone) {
  EXPECT_EQ(AssertedVolume::parse("table_1 0.2 0.1 0.05 0.1").numbers.size(), 4U);
  for (const char* text : {"", "map", "map 1 2 3", "map 1 2 3 -1", "map 1 2 x 1", "map 1 2 3 1 1"})
    EXPECT_THROW(AssertedVolume::parse(text), Error) << text;
}

}  // namespace
}  // namespace loci::perception
