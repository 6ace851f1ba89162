#include "memory/annotators/cas_to_scene.h"

#include "memory/recorder/observation_pixels.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "memory/store/scene_images.h"
#include "perception/conversions/opencv.h"
#include "perception/types/geometry.h"

namespace loci::memory {
namespace {

TEST(RobustBox, OutliersDoNotCount) {
  std::vector<Vector3d> points;
  for (int i = 0; i <= 1000; ++i) points.emplace_back(i / 1000.0, 0.5, 0.0);
  points.emplace_back(50, 50, 50);
  const belief::AxisBox box = robust_box(points);
  EXPECT_NEAR(box.centre.x(), 0.5, 0.01);
  EXPECT_NEAR(box.size.x(), 0.98, 0.02);
  EXPECT_NEAR(box.centre.z(), 0, 1e-9);
  EXPECT_TRUE(robust_box({}).size.isZero());
}

TEST(CasToScene, AnExtentIsSeenOnFacesThatRunAlongIt) {
  perception::cas::Cas cas(perception::types::type_system());
  const auto seen = [&](const Vector3d& size, const Vector3d& camera) {
    const auto cluster = perception::types::Cluster::create(cas);
    const auto geometry = perception::types::GeometryAnnotation::create(cas);
    geometry.map_from_object.set(
        perception::types::to_stamped(cas, Isometry3d::Identity(), "map", "object", 7 * kSecond));
    geometry.size.set(perception::types::to(cas, size));
    cluster.annotations.push_back(geometry);
    const std::vector<float> values = descriptors_of(cluster, camera).at(0).values;
    return std::vector<float>(values.begin() + 3, values.end());
  };
  const Vector3d box(0.2, 0.07, 0.28);
  EXPECT_EQ(seen(box, {0, -1.2, 0.7}), (std::vector<float>{1, 1, 1})) << "from above";
  EXPECT_EQ(seen(box, {0.8, -1.2, 0}), (std::vector<float>{1, 1, 1})) << "from its side";
  EXPECT_EQ(seen(box, {0, -1.2, 0.1}), (std::vector<float>{1, 0, 1})) << "its front alone";
  EXPECT_EQ(seen({0.2, 0.008, 0.28}, {0, -1.2, 0.4}), (std::vector<float>{1, 0, 1}))
      << "the top should be seen, but was not";
}

TEST(CasToScene, AClassThatIsNotSureEnoughIsStoredAsAGuess) {
  perception::cas::Cas cas(perception::types::type_system());
  const auto annotation = perception::types::ClassificationAnnotation::create(cas);
  EXPECT_EQ(annotation_record(annotation).value, "");
  const auto guess = perception::types::ClassConfidence::create(cas);
  guess.name.set("box");
  annotation.confidences.push_back(guess);
  EXPECT_EQ(annotation_record(annotation).value, "box");
  annotation.label.set("book");
  EXPECT_EQ(annotation_record(annotation).value, "book");
}

TEST(CasToScene, ReadsAnnotations) {
  perception::cas::Cas cas(perception::types::type_system());
  const perception::types::SceneCas facade(cas);
  const perception::types::Scene scene = facade.create_scene();
  scene.timestamp.set(7 * kSecond);
  scene.frame_index.set(3);
  perception::types::set_cameras(facade, mapping::RgbdCamera{});
  scene.map_from_camera.set(
      perception::types::to_stamped(cas, Isometry3d::Identity(), "map", "depth_camera", 7 * kSecond));
  cv::Mat depth(480, 640, CV_32F, cv::Scalar(1.0));
  depth.at<float>(240, 320) = std::numeric_limits<float>::quiet_NaN();
  perception::types::set_view_image(facade, perception::types::SceneCas::kDepth, depth);
  const auto support = perception::types::PlanarSupport::create(cas);
  support.name.set("table_1");
  support.support_class.set("table");
  facade.add_support(support);
  const auto cluster = perception::types::Cluster::create(cas);
  const auto points = perception::types::ReferenceClusterPoints::create(cas);
  std::vector<int32_t> indices;
  for (int v = 230; v < 250; ++v)
    for (int u = 310; u < 330; ++u) indices.push_back(v * 640 + u);
  points.indices.get_or_create().indices.set(indices);
  cluster.hypotheses.push_back(points);
  cluster.support.set(support);
  cluster.at_image_border.set(true);
  const auto color = perception::types::ColorAnnotation::create(cas);
  color.names.set(std::vector<std::string>{"red"});
  color.mean_hue.set(0);
  color.mean_saturation.set(1);
  color.mean_value.set(0.5);
  cluster.annotations.push_back(color);
  facade.add_cluster(cluster);

  for (const bool moved : {true, false}) {
    const auto joint = perception::types::JointAnnotation::create(cas);
    joint.joint.set(moved ? "drawer" : "door");
    joint.moved.set(moved);
    scene.annotations.push_back(joint);
  }

  cv::Mat structure(480, 640, CV_8U, cv::Scalar(1));
  structure(cv::Rect(310, 230, 20, 20)) = 3;
  perception::types::set_view_image(facade, "structure", structure);
  facade.log("NormalEstimator", "info", "done", 12.5);
  facade.log("KnownStructureFilter", "info", "drawer_1_joint stands at 0.300");

  SceneRecord record = scene_record(facade, nullptr);
  add_stored_data(facade, true, record);
  EXPECT_EQ(record.kinds.at<uint8_t>(240, 320), 3);
  ASSERT_EQ(record.log.size(), 2U);
  EXPECT_EQ(record.log[0].annotator, "NormalEstimator");
  EXPECT_EQ(record.log[0].text, "") << "its time says that it is done";
  EXPECT_EQ(record.log[0].milliseconds, 12.5);
  EXPECT_EQ(record.log[1].text, "drawer_1_joint stands at 0.300");
  EXPECT_FALSE(record.log[1].milliseconds.has_value());
  const std::vector<float> cloud = decode_cluster_depth(record.observations.at(0).cloud.bytes);
  ASSERT_EQ(cloud.size(), 400U);
  EXPECT_FLOAT_EQ(cloud[0], 1);
  EXPECT_EQ(cloud[10 * 20 + 10], 0) << "not measured";
  SceneRecord without = scene_record(facade, nullptr);
  add_stored_data(facade, false, without);
  EXPECT_TRUE(without.observations.at(0).cloud.bytes.empty());
  const auto kept = [&](const std::string& name) {
    return std::count_if(record.structures.begin(), record.structures.end(), [&](const auto& each) {
      const auto joint = perception::types::try_as<perception::types::JointAnnotation>(each);
      return joint && joint->joint.get() == name;
    });
  };
  EXPECT_EQ(kept("drawer"), 1);
  EXPECT_EQ(kept("door"), 0) << "an assumed position is not stored";
  EXPECT_EQ(record.row.time, 7 * kSecond);
  EXPECT_EQ(record.row.frame_index, 3);
  ASSERT_EQ(record.places.size(), 1U);
  EXPECT_EQ(record.places[0].class_name, "table");
  ASSERT_EQ(record.observations.size(), 1U);
  const ObservationRecord& observation = record.observations[0];
  EXPECT_EQ(observation.evidence.place, "table_1");
  EXPECT_TRUE(observation.evidence.partial);
  EXPECT_EQ(observation.evidence.points, 399) << "a pixel without measurement has no point";
  EXPECT_NEAR(observation.evidence.box.centre.z(), 1, 1e-6);
  EXPECT_EQ(observation.row.color, "red");
  EXPECT_EQ(observation.row.roi, (std::array<int, 4>{310, 230, 20, 20}));
  ASSERT_EQ(observation.evidence.descriptors.size(), 1U);
  EXPECT_EQ(observation.evidence.descriptors[0].values, (std::vector<float>{0.5F, 0.0F, 0.0F}));
  EXPECT_EQ(record.view.labels.at<int>(240, 320), 0);
  EXPECT_EQ(record.view.labels.at<int>(0, 0), -1);
}

}  // namespace
}  // namespace loci::memory
