#include "perception/annotators/segmentation/superpixels.h"
#include "mapping/base/math/math.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <opencv2/imgproc.hpp>

#include "mapping/base/config.h"
#include "mapping/base/files.h"
#include "mapping/image/image_io.h"
#include "perception/annotators/scene_data.h"
#include "perception/annotators/structure/normals.h"
#include "perception/conversions/opencv.h"

namespace loci::perception {
namespace {

namespace fs = std::filesystem;

const mapping::PinholeCamera kSmallCamera{160, 120, 146, 146, 80, 60};
const cv::Vec3f kGrey(60, 0, 0), kRed(50, 70, 50);

/// A wall 2 m away, and before its left half a board at 1 m; a red patch of 6 x 6 cm in the middle of the
/// wall's right half.
struct Scene {
  cv::Mat points, normals, lab{kSmallCamera.height, kSmallCamera.width, CV_32FC3, cv::Scalar(60, 0, 0)};

  Scene() {
    cv::Mat depth(kSmallCamera.height, kSmallCamera.width, CV_32F, cv::Scalar(2));
    depth(cv::Rect(0, 0, 80, 120)).setTo(1);
    points = points_from_depth(depth, kSmallCamera);
    normals = normals_from_depth(depth, kSmallCamera);
    const Vector2d low = kSmallCamera.project({0.5 - 0.03, -0.03, 2}),
                   high = kSmallCamera.project({0.5 + 0.03, 0.03, 2});
    lab(cv::Rect(cv::Point(cvRound(low.x()), cvRound(low.y())),
                 cv::Point(cvRound(high.x()), cvRound(high.y()))))
        .setTo(cv::Scalar(kRed[0], kRed[1], kRed[2]));
  }
  Superpixels find(double radius) const {
    SuperpixelOptions options;
    options.radius_m = radius;
    return find_superpixels(points, normals, lab, kSmallCamera, options);
  }
};

TEST(Superpixels, AreOfOneSizeInSpaceAndDoNotReachOverEdges) {
  const Scene scene;
  const Superpixels found = scene.find(0.05);
  std::map<bool, std::vector<double>> areas;  // by whether on the board
  for (size_t k = 0; k < found.all.size(); ++k) {
    const Superpixel& each = found.all[k];
    EXPECT_TRUE(std::abs(each.position.z() - 1) < 1e-6 || std::abs(each.position.z() - 2) < 1e-6)
        << "on the board or on the wall, not on both: " << each.position.z();
    const double pixel = each.position.z() / kSmallCamera.fx;
    areas[each.position.z() < 1.5].push_back(each.pixels * pixel * pixel);
  }
  for (const auto& [board, its] : areas) {
    double sum = 0;
    for (const double area : its) sum += area;
    const double expected = kPi * 0.05 * 0.05;
    EXPECT_NEAR(sum / static_cast<double>(its.size()), expected, 0.25 * expected) << board;
  }
}

TEST(Superpixels, AreConnectedAndNumberEveryMeasuredPixelWithANormal) {
  const Scene scene;
  const Superpixels found = scene.find(0.05);
  std::vector<int> pixels(found.all.size() + 1, 0);
  for (int v = 0; v < kSmallCamera.height; ++v)
    for (int u = 0; u < kSmallCamera.width; ++u) {
      const int label = found.labels.at<uint16_t>(v, u);
      if (label > 0) ++pixels.at(static_cast<size_t>(label));
      const bool known = std::isfinite(scene.normals.at<cv::Vec3f>(v, u)[2]);
      EXPECT_EQ(label > 0, known) << u << ", " << v;
    }
  for (size_t k = 0; k < found.all.size(); ++k) {
    EXPECT_EQ(pixels[k + 1], found.all[k].pixels);
    cv::Mat pieces;
    EXPECT_EQ(cv::connectedComponents(found.labels == static_cast<int>(k + 1), pieces, 4), 2) << k;
  }
}

TEST(Superpixels, KeepColoursApart) {
  const Scene scene;
  const Superpixels found = scene.find(0.03);
  int mixed = 0, red = 0;
  for (const Superpixel& each : found.all) {
    const double share = each.lab.y() / static_cast<double>(kRed[1]);
    red += share > 0.9 ? 1 : 0;
    mixed += share > 0.2 && share < 0.8 ? 1 : 0;
  }
  EXPECT_GE(red, 1);
  EXPECT_LE(mixed, 1);
}

TEST(Superpixels, WeightsLeaveSomethingForThePlace) {
  SuperpixelOptions options;
  options.color = 0.6;
  options.normal = 0.5;
  const Scene scene;
  EXPECT_THROW(find_superpixels(scene.points, scene.normals, scene.lab, kSmallCamera, options), Error);
}

TEST(Superpixels, NothingMeasuredIsNoneAtAll) {
  Scene scene;
  scene.points.setTo(cv::Scalar::all(std::nan("")));
  const Superpixels found = scene.find(0.05);
  EXPECT_TRUE(found.all.empty());
  EXPECT_EQ(cv::countNonZero(found.labels), 0);
  EXPECT_TRUE(salient_balls(found, saliency(found, 0.3), 0.6, 0.1, 0.3, 5).empty());
}

TEST(Saliency, WhatStandsOutByItsColourIsABall) {
  const Scene scene;
  const Superpixels found = scene.find(0.03);
  const auto balls = salient_balls(found, saliency(found, 0.25), 0.6, 0.075, 0.2, 5);
  ASSERT_FALSE(balls.empty());
  EXPECT_LT((balls[0].center - Vector3d(0.5, 0, 2)).norm(), 0.03);
  EXPECT_LT(balls[0].radius, 0.12);
  EXPECT_EQ(balls[0].saliency, 1);
}

TEST(Saliency, WhereAllIsAlikeThereIsNoBall) {
  Scene scene;
  scene.lab.setTo(cv::Scalar(kGrey[0], kGrey[1], kGrey[2]));
  const Superpixels found = scene.find(0.03);
  EXPECT_TRUE(salient_balls(found, saliency(found, 0.25), 0.6, 0.075, 0.2, 5).empty());
}

TEST(Saliency, NoBallBeginsInAnotherOne) {
  Superpixels patches;
  std::vector<double> values;
  for (int i = 0; i < 100; ++i) {  // A row of them, of which those at 0.50, 0.51 and 0.80 m stand out.
    patches.all.push_back({Vector3d(0.01 * i, 0, 1), Vector3d(0, 0, -1), Vector3d::Zero(), 50});
    values.push_back(i == 50 ? 1.0 : i == 51 ? 0.3 : i == 80 ? 0.25 : 0.01 + 0.0001 * (i % 7));
  }
  const auto balls = salient_balls(patches, values, 0.6, 0.03, 0.2, 5);
  ASSERT_EQ(balls.size(), 2U);
  EXPECT_NEAR(balls[0].center.x(), 0.5, 1e-9);
  EXPECT_NEAR(balls[1].center.x(), 0.8, 1e-9);
}

/// The scene of above as a CAS, its camera 1 m above the map's origin.
struct SceneInCas {
  cas::Cas cas{types::type_system()};
  types::SceneCas scene{cas};
  Isometry3d map_from_camera = Isometry3d(Eigen::Translation3d(0, 0, 1));

  SceneInCas() {
    const Scene made;
    scene.create_scene().map_from_camera.set(
        types::to_stamped(cas, map_from_camera, "map", "depth_camera", 0));
    mapping::RgbdCamera camera;
    camera.depth = camera.color = kSmallCamera;
    types::set_cameras(scene, camera);
    cv::Mat color;
    cv::cvtColor(made.lab, color, cv::COLOR_Lab2BGR);
    color.convertTo(color, CV_8U, 255);
    types::set_view_image(scene, types::SceneCas::kColor, color);
    set_cloud_points(scene, made.points);
    set_cloud_normals(scene, made.normals);
  }
  types::Cluster add_cluster(const cv::Rect& region) {
    std::vector<int32_t> indices;
    for (int v = region.y; v < region.br().y; ++v)
      for (int u = region.x; u < region.br().x; ++u) indices.push_back(v * kSmallCamera.width + u);
    const auto points = types::ReferenceClusterPoints::create(cas);
    points.indices.get_or_create().indices.set(std::move(indices));
    const auto cluster = types::Cluster::create(cas);
    cluster.hypotheses.push_back(points);
    scene.add_cluster(cluster);
    return cluster;
  }
  template <class A>
  void run(const std::string& options) {
    A annotator;
    OptionTable table;
    annotator.declare(table);
    table.read(Config::parse(options, "test"));
    Resources resources;
    Warnings warnings;
    Context context{resources, warnings, 1, {}};
    annotator.process(cas, context);
  }
};

TEST(SuperpixelExtractor, MakesAViewOfLabels) {
  SceneInCas there;
  there.run<SuperpixelExtractor>("radius_m: 0.05");
  const cv::Mat labels = types::view_image(there.scene, kSuperpixelsView);
  EXPECT_EQ(labels.type(), CV_16U);
  EXPECT_EQ(cv::countNonZero(cv::Mat(labels == Scene().find(0.05).labels)), labels.rows * labels.cols);
}

TEST(SaliencyDetector, BallsAreHypothesesInTheMapFrame) {
  SceneInCas there;
  const types::Cluster patch = there.add_cluster(cv::Rect(114, 58, 5, 5));
  const types::Cluster wall = there.add_cluster(cv::Rect(90, 10, 60, 100));
  there.run<SaliencyDetector>("radius_m: 0.03");
  const auto balls = types::select<types::TFLinkSphereROI>(there.cas, kSaliencyView);
  ASSERT_FALSE(balls.empty());
  EXPECT_EQ(balls[0].tf_frame.get(), "map");
  EXPECT_LT((types::from<Vector3d>(balls[0].center.get()) - Vector3d(0.5, 0, 3)).norm(), 0.03);
  EXPECT_EQ(types::view_image(there.scene, kSaliencyView).type(), CV_8U);
  EXPECT_TRUE(patch.hypotheses.first<types::TFLinkSphereROI>());
  EXPECT_FALSE(wall.hypotheses.first<types::TFLinkSphereROI>());
}

/// An image of a table whose objects are labelled (tens of the label from 20 on), and what stands out in it.
struct LabelledTable {
  cv::Mat points, labels;
  std::vector<SalientBall> balls;

  explicit LabelledTable(const std::string& name) {
    const mapping::PinholeCamera camera{640, 480, 525, 525, 319.5, 239.5};
    cv::Mat depth;
    const cv::Mat raw = mapping::read_uint16(name + "_depth.png");
    raw.convertTo(depth, CV_32F, 0.001);
    depth.setTo(std::numeric_limits<float>::quiet_NaN(), raw == 0);
    const std::string bytes = read_file(name + "_label.png");
    labels = mapping::decode_image({bytes.begin(), bytes.end()}, name);
    const cv::Mat smoothed = smooth_depth(depth, camera);
    points = points_from_depth(smoothed, camera);
    mapping::RgbdCamera cameras;
    cameras.depth = cameras.color = camera;
    const Superpixels found = find_superpixels(
        points, normals_from_depth(smoothed, camera),
        lab_of_points(points, mapping::read_color(name + "_color.png"), cameras), camera, {});
    balls = salient_balls(found, saliency(found, 0.25), 0.6, 0.05, 0.2, 10);
  }
};

class SaliencyOnTables : public testing::TestWithParam<const char*> {};

TEST_P(SaliencyOnTables, BallsHoldTheObjectsAndLieOnThem) {
  const fs::path folder = fs::path(LOCI_SHARED_DIR) / "data" / GetParam();
  if (!fs::exists(folder)) GTEST_SKIP() << "needs " << folder;
  int objects = 0, held = 0, balls = 0, on_objects = 0;
  for (const auto& file : fs::directory_iterator(folder)) {
    const std::string name = file.path().string(), ending = "_label.png";
    if (!name.ends_with(ending)) continue;
    const LabelledTable table(name.substr(0, name.size() - ending.size()));
    std::map<int, std::pair<int, int>> seen;  // of each object: points, those in a ball
    std::vector<std::pair<double, int>> nearest(table.balls.size(), {1e9, 0});
    for (int i = 0; i < table.points.rows * table.points.cols; ++i) {
      const cv::Vec3f& at = table.points.ptr<cv::Vec3f>()[i];
      if (!std::isfinite(at[2])) continue;
      const int object = table.labels.ptr<uint8_t>()[i] / 10;
      bool inside = false;
      for (size_t b = 0; b < table.balls.size(); ++b) {
        const double away =
            (Eigen::Vector3f(at[0], at[1], at[2]).cast<double>() - table.balls[b].center).norm();
        inside = inside || away <= table.balls[b].radius;
        if (away < nearest[b].first) nearest[b] = {away, object};
      }
      if (object < 2) continue;
      ++seen[object].first;
      seen[object].second += inside ? 1 : 0;
    }
    for (const auto& [object, points] : seen) {
      ++objects;
      held += 2 * points.second >= points.first ? 1 : 0;
    }
    for (const auto& [away, object] : nearest) {
      ++balls;
      on_objects += object >= 2 ? 1 : 0;
    }
  }
  RecordProperty("objects", objects);
  RecordProperty("held", held);
  RecordProperty("balls", balls);
  RecordProperty("on_objects", on_objects);
  EXPECT_GE(held, 0.9 * objects) << "objects, at least half of whose points are in a ball, of " << objects;
  EXPECT_GE(on_objects, 2.0 / 3 * balls) << "balls whose middle is nearest to an object, of " << balls;
}

INSTANTIATE_TEST_SUITE_P(Real, SaliencyOnTables, testing::Values("osd_tabletop", "osd_changes"));

}  // namespace
}  // namespace loci::perception
