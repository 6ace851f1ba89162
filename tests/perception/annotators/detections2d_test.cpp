#include "perception/annotators/segmentation/detections2d.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "perception/annotators/scene_data.h"
#include "perception/annotators/segmentation/clustering/plane_cluster_extractor.h"
#include "perception/annotators/structure/known_structure.h"
#include "perception/conversions/opencv.h"
#include "perception/detection/lift.h"
#include "tests/perception/annotators/synthetic_table.h"

namespace loci::perception {
namespace {

/// A plate on a table, the CAS of its frame, and the pixels of the plate.
class PlateScene {
 public:
  PlateScene() {
    test::SyntheticTable table;
    table.rounds = {{{Vector3d::Zero(), 0.022, 0.06, 0.12}}};
    pose_ = table.map_from_camera;
    scene_.create_scene().map_from_camera.set(types::to_stamped(cas_, pose_, "map", "depth_camera", 0));
    mapping::RgbdCamera camera;
    camera.depth = camera.color = table.camera;
    types::set_cameras(scene_, camera);
    set_cloud_points(scene_, points_of(table.render(0.2, labels_), table.camera));
    for (int i = 0; i < static_cast<int>(labels_.total()); ++i)
      if (labels_.ptr<int>()[i] == 1) plate_.push_back(i);
  }

  types::SceneCas& scene() { return scene_; }
  const std::vector<int>& plate() const { return plate_; }
  const cv::Mat& labels() const { return labels_; }

  void add_cluster(const std::vector<int>& pixels) {
    const auto cluster = types::Cluster::create(cas_);
    set_points(cluster, "test", pixels, scene_, pose_);
    scene_.add_cluster(cluster);
  }
  /// A box around what the labels show of the plate.
  void detect() {
    Detection2D detection;
    detection.region.box = box_around(plate_);
    detection.classes = {{"plate", 0.9}};
    Tally lifted("detection");
    add_detections(cas_, {detection}, "test", lifted);
  }

 private:
  cv::Rect2d box_around(const std::vector<int>& pixels) const {
    std::vector<cv::Point> points;
    for (const int pixel : pixels) points.emplace_back(pixel % labels_.cols, pixel / labels_.cols);
    return cv::boundingRect(points);
  }

  cas::Cas cas_{types::type_system()};
  types::SceneCas scene_{cas_};
  Isometry3d pose_;
  cv::Mat labels_;
  std::vector<int> plate_;
};

TEST(Detections2D, AFlatObjectStaysOneClusterWithItsClass) {
  PlateScene plate;
  plate.add_cluster(plate.plate());
  plate.detect();
  const std::vector<types::Cluster> clusters = plate.scene().clusters();
  ASSERT_EQ(clusters.size(), 1U);
  const auto label = clusters[0].annotations.first<types::ClassificationAnnotation>();
  ASSERT_TRUE(label);
  EXPECT_EQ(label.label.get(), "plate");
}

TEST(Detections2D, AClusterThatIsMostlyOutsideOfTheRegionIsAnotherObject) {
  PlateScene plate;
  std::vector<int> tray;
  for (int i = 0; i < static_cast<int>(plate.labels().total()); ++i)
    if (plate.labels().ptr<int>()[i] >= 0) tray.push_back(i);
  plate.add_cluster(tray);
  plate.detect();
  EXPECT_EQ(plate.scene().clusters().size(), 2U);
}

TEST(Detections2D, WhatTheMapExplainsIsNotDetected) {
  PlateScene plate;
  const auto explained = static_cast<double>(mapping::PixelKind::map_explained);
  types::set_view_image(plate.scene(), kStructureView,
                        cv::Mat(plate.labels().size(), CV_8U, cv::Scalar(explained)));
  plate.detect();
  EXPECT_TRUE(plate.scene().clusters().empty());
}

}  // namespace
}  // namespace loci::perception
