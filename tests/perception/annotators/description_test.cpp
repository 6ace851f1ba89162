#include <gmock/gmock.h>

#include <map>

#include "mapping/base/math/math.h"
#include "mapping/image/hsv.h"
#include "perception/annotators/annotators.h"
#include "perception/annotators/description/color_annotators.h"
#include "perception/annotators/description/geometry_annotators.h"
#include "perception/annotators/description/shape_annotators.h"
#include "perception/types/geometry.h"
#include "perception/types/scene_cas.h"

namespace loci::perception {
namespace {

using ::testing::ElementsAre;

TEST(ColorName, HuesAcrossZeroHaveARedMean) {
  cv::Mat image(1, 2, CV_8UC3);
  image.at<cv::Vec3b>(0, 0) = {20, 0, 200};  // Hue 354.
  image.at<cv::Vec3b>(0, 1) = {0, 20, 200};  // Hue 6.
  const NamedColors colors = name_colors(image, cv::Mat(1, 2, CV_8U, cv::Scalar(255)), 0.05);
  EXPECT_THAT(colors.names, ElementsAre("red"));
  EXPECT_NEAR(std::remainder(colors.mean_hue, 360), 0, 1);
}

TEST(ColorName, KnowsTheWords) {
  EXPECT_STREQ(mapping::color_name(0, 0, 0.9f), "white");
  EXPECT_STREQ(mapping::color_name(0, 0, 0.5f), "grey");
  EXPECT_STREQ(mapping::color_name(200, 0.9f, 0.1f), "black");
  EXPECT_STREQ(mapping::color_name(0, 0.9f, 0.8f), "red");
  EXPECT_STREQ(mapping::color_name(55, 0.9f, 0.8f), "yellow");
  EXPECT_STREQ(mapping::color_name(120, 0.9f, 0.8f), "green");
  EXPECT_STREQ(mapping::color_name(220, 0.9f, 0.8f), "blue");
  EXPECT_STREQ(mapping::color_name(28, 0.7f, 0.4f), "brown");
}

TEST(ColorHistogram, SumsToOneAndPutsGreyInTheFirstBin) {
  const cv::Mat mask(4, 4, CV_8U, cv::Scalar(255));
  const auto grey = hue_saturation_histogram(cv::Mat(4, 4, CV_8UC3, cv::Scalar(99, 100, 101)), mask, 12, 4);
  EXPECT_FLOAT_EQ(grey[0], 1);
  const auto blue = hue_saturation_histogram(cv::Mat(4, 4, CV_8UC3, cv::Scalar(255, 0, 0)), mask, 12, 4);
  EXPECT_FLOAT_EQ(blue[8 * 4 + 3], 1);
}

TEST(Geometry, TheBoxIsUprightTightAndReachesTheGround) {
  const double yaw = 0.4;
  std::vector<Vector3d> points;
  for (double x = -0.1; x <= 0.1; x += 0.005)
    for (double y = -0.03; y <= 0.03; y += 0.005)
      for (double z = 0.73; z <= 0.80; z += 0.01)
        points.push_back(Eigen::AngleAxisd(yaw, Vector3d::UnitZ()) * Vector3d(x, y, z) + Vector3d(1, 2, 0));
  const UprightBox box = upright_box(points, 0.72, 0.04, 0);
  EXPECT_NEAR(box.size.x(), 0.2, 0.01);
  EXPECT_NEAR(box.size.y(), 0.06, 0.01);
  EXPECT_NEAR(box.size.z(), 0.08, 0.011);
  EXPECT_NEAR(box.map_from_box.translation().x(), 1, 0.005);
  const Vector3d x = box.map_from_box.linear().col(0);
  EXPECT_NEAR(std::remainder(std::atan2(x.y(), x.x()) - yaw, kPi), 0, 0.05);
}

TEST(Location, SaysOnWhatAndHowFarFromWhichEdge) {
  EXPECT_EQ(place_phrase("table_1", "table"), "on table_1");
  EXPECT_EQ(place_phrase("drawer_2_bottom", "drawer_bottom"), "in drawer_2");
  EXPECT_EQ(place_phrase("", ""), "on a surface");
  const std::vector<Vector2d> outline = {{-0.6, -0.4}, {0.6, -0.4}, {0.6, 0.4}, {-0.6, 0.4}};
  EXPECT_EQ(edge_phrase({-0.3, 0}, outline), "0.30 m from its left edge");
  EXPECT_EQ(edge_phrase({0, 0.35}, outline), "0.05 m from its back edge");
  EXPECT_EQ(edge_phrase({-0.61, 0}, outline), "0.01 m from its left edge") << "it reaches over";
  const std::vector<Vector2d> corner = {{-1, -1}, {2, -1}, {2, -0.4}, {-0.4, -0.4}, {-0.4, 2}, {-1, 2}};
  EXPECT_EQ(edge_phrase({-0.5, 1}, corner), "0.10 m from its right edge");
  EXPECT_EQ(edge_phrase({1, -0.45}, corner), "0.05 m from its back edge");
}

TEST(Relations, WhatLiesToTheLeftIsLeftOfItAndDiagonalsAreShared) {
  const Footprint cup{{0, 0}, {0.04, 0.04}, 0}, plate{{0.3, 0}, {0.1, 0.1}, 0.5};
  const Vector2d away(0, 1);
  const Arrangement left = arrangement_of(cup, plate, away);
  EXPECT_GT(left.left_of, 0.95);
  EXPECT_NEAR(left.gap_m, 0.13, 0.05);
  EXPECT_EQ(left.over, 0);
  EXPECT_NEAR(arrangement_of(plate, cup, away).right_of, left.left_of, 1e-9);
  // From the left side of the table the cup is nearer.
  EXPECT_GT(arrangement_of(cup, plate, {1, 0}).in_front_of, 0.95);
  const Arrangement diagonal = arrangement_of(cup, {{0.2, 0.2}, {0.04, 0.04}, 0}, away);
  EXPECT_NEAR(diagonal.left_of, 0.5, 0.1);
  EXPECT_NEAR(diagonal.in_front_of, 0.5, 0.1);
  const Arrangement upon = arrangement_of(cup, {{0.01, 0}, {0.1, 0.1}, 0}, away);
  EXPECT_NEAR(upon.over, 1, 1e-9);
  EXPECT_EQ(upon.gap_m, 0);
}

TEST(Relations, TheSceneGetsATableAndEachThingAWordForItsSize) {
  cas::Cas cas(types::type_system());
  const types::SceneCas scene(cas);
  Isometry3d map_from_camera = Isometry3d::Identity();  // It looks along y of the map.
  map_from_camera.linear() = Eigen::AngleAxisd(-kPi / 2, Vector3d::UnitX()).toRotationMatrix();
  scene.create_scene().map_from_camera.set(types::to_stamped(cas, map_from_camera, "map", "camera", 0));
  const auto put = [&](double x, double size) {
    const auto cluster = types::Cluster::create(cas);
    const auto geometry = types::GeometryAnnotation::create(cas);
    geometry.map_from_object.set(types::to(cas, Isometry3d(Eigen::Translation3d(x, 0, 0))));
    geometry.size.set(types::to(cas, Vector3d(Vector3d::Constant(size))));
    cluster.annotations.push_back(geometry);
    scene.add_cluster(cluster);
    return cluster;
  };
  const types::Cluster cup = put(0, 0.08), jug = put(0.3, 0.2);
  Resources resources;
  Warnings warnings;
  Context context{resources, warnings, 1, {}};
  RelationsAnnotator().process(cas, context);
  SizeAnnotator().process(cas, context);
  std::map<std::string, double> said;
  for (const types::Relation& relation : scene.scene().relations.to_vector())
    if (relation.object1.get() == cup && relation.object2.get() == jug)
      said[relation.name.get()] = relation.probability.get();
  EXPECT_GT(said["left-of"], 0.9);
  EXPECT_GT(said["near"], 0.1);
  EXPECT_FALSE(said.contains("in-front-of"));
  EXPECT_EQ(cup.annotations.first<types::SizeAnnotation>().size.get(), "small");
  EXPECT_EQ(jug.annotations.first<types::SizeAnnotation>().size.get(), "medium");
}

TEST(Annotators, EveryTypeThatTheyNameExists) {
  AnnotatorRegistry registry;
  add_annotators(registry);
  for (const std::string& name : registry.annotators()) {
    const AnnotatorDescriptor descriptor = registry.make(name)->descriptor();
    EXPECT_FALSE(descriptor.description.empty());
    std::vector<std::string> products = descriptor.outputs;
    products.insert(products.end(), descriptor.inputs.begin(), descriptor.inputs.end());
    for (const std::string& product : products) {
      if (product.starts_with("view:")) continue;
      const size_t dot = product.find('.');  // Of a type, or of a feature of it.
      bool known = false;
      for (const char* space : {"core", "cv", "tf", "pcl", "hypothesis", "annotation", "scene", "belief"}) {
        const auto type =
            types::type_system()->find("loci." + std::string(space) + "." + product.substr(0, dot));
        known = known || (type && (dot == std::string::npos || type->find_feature(product.substr(dot + 1))));
      }
      EXPECT_TRUE(known) << name << ": " << product;
    }
  }
}

}  // namespace
}  // namespace loci::perception
