#include <gtest/gtest.h>

#include <limits>

#include "perception/annotators/annotators.h"
#include "perception/annotators/scene_data.h"
#include "perception/conversions/opencv.h"
#include "perception/pipeline/pipeline.h"

namespace loci::perception {
namespace {

/// One frame: a plane at z = 1 m, of which some pixels are a cluster with an image of one pixel.
class TinyReader : public Reader {
 public:
  explicit TinyReader(std::vector<int32_t> pixels = {}) : pixels_(std::move(pixels)) {}

  AnnotatorDescriptor descriptor() const override {
    return {"TinyReader",
            "",
            {},
            {"Scene", "CameraInfo", "view:depth", "view:color", "view:cloud", "view:normals", "PlanarSupport",
             "Cluster", "ReferenceClusterPoints", "StandaloneImageROI"}};
  }
  void start(Context& /*context*/) override {}
  size_t count() const override { return 1; }
  size_t position() const override { return position_; }
  FrameId upcoming() const override { return {}; }
  void skip(size_t frames) override { position_ += frames; }

  void read_next(cas::Cas& cas, Context& /*context*/) override {
    ++position_;
    const types::SceneCas scene(cas);
    scene.create_scene().map_from_camera.set(
        types::to_stamped(cas, Isometry3d(Isometry3d::Identity()), "map", "depth_camera", 0));
    mapping::RgbdCamera camera;
    camera.depth = camera.color = {40, 40, 100, 100, 20, 20};
    types::set_cameras(scene, camera);
    types::set_view_image(scene, types::SceneCas::kDepth, cv::Mat(40, 40, CV_32F, cv::Scalar(1)));
    types::set_view_image(scene, types::SceneCas::kColor, cv::Mat(40, 40, CV_8UC3, cv::Scalar(9, 90, 200)));
    cv::Mat points(40, 40, CV_32FC3);
    for (int v = 0; v < 40; ++v)
      for (int u = 0; u < 40; ++u)
        points.at<cv::Vec3f>(v, u) = {0.01f * static_cast<float>(u - 20), 0.01f * static_cast<float>(v - 20),
                                      1};
    set_cloud_points(scene, points);
    set_cloud_normals(scene, cv::Mat(40, 40, CV_32FC3, cv::Scalar(0, 0, -1)));
    const auto support = types::PlanarSupport::create(cas);
    support.normal.set(types::to(cas, Vector3d(0, 0, -1)));
    support.offset.set(-1);
    support.map_from_support.set(types::to(cas, Isometry3d(Isometry3d::Identity())));
    scene.add_support(support);
    add_cluster(scene, support);
  }

 private:
  void add_cluster(const types::SceneCas& scene, const types::PlanarSupport& support) const {
    cas::Cas& cas = scene.cas();
    const auto cluster = types::Cluster::create(cas);
    const auto reference = types::ReferenceClusterPoints::create(cas);
    reference.cloud.set(scene.cloud());
    reference.indices.get_or_create().indices.set(pixels_);
    cluster.hypotheses.push_back(reference);
    const auto roi = types::StandaloneImageROI::create(cas);
    roi.roi.set(types::to(cas, cv::Rect(10, 10, 1, 1)));
    roi.mask.set(types::to(cas, cv::Mat(1, 1, CV_8U, cv::Scalar(255))));
    roi.image.set(types::to(cas, cv::Mat(1, 1, CV_8UC3, cv::Scalar(9, 90, 200))));
    cluster.hypotheses.push_back(roi);
    cluster.centroid.set(types::to(cas, Vector3d(0, 0, 1)));
    cluster.support.set(support);
    scene.add_cluster(cluster);
  }

  std::vector<int32_t> pixels_;
  size_t position_ = 0;
};

class OnePoint : public TinyReader {
 public:
  OnePoint() : TinyReader({410}) {}
};
class NoPoint : public TinyReader {};
class Line : public TinyReader {
 public:
  Line() : TinyReader({410, 411, 412, 413}) {}
};

/// A pipeline refuses numbers that are none, so that running it is the test.
template <class Tiny>
class TinyClusters : public ::testing::Test {};
using Tinies = ::testing::Types<OnePoint, NoPoint, Line>;
TYPED_TEST_SUITE(TinyClusters, Tinies);

TYPED_TEST(TinyClusters, NoAnnotatorStumblesOverThem) {
  AnnotatorRegistry registry;
  add_annotators(registry);
  registry.add_reader<TypeParam>();
  for (const char* flow :
       {"FlatObjectExtractor", "ColorHistogram", "ColorName", "GeometryAnnotator", "LocationAnnotator",
        "BarcodeReader", "TextReader",
        "PclFeature: {features: [VFH, CVFH, ESF, GRSD, PFH, FPFH, SHOT, SpinImage, GaussImage]}"}) {
    SCOPED_TRACE(flow);
    Pipeline pipeline =
        Pipeline::parse(std::string("reader: TinyReader\nflow:\n  - ") + flow + "\n", "test", registry);
    Resources resources;
    Warnings warnings;
    NoProgress progress;
    Context context{resources, warnings, 1, {}};
    size_t scenes = 0;
    EXPECT_NO_THROW(pipeline.run(context, types::type_system(), progress, [&](cas::Cas&) { ++scenes; }));
    EXPECT_EQ(scenes, 1U);
  }
}

/// A table from above on which a thin box lies; `taken`: its points were taken out of the cloud.
template <bool taken>
class ThinBox : public TinyReader {
 public:
  void read_next(cas::Cas& cas, Context& context) override {
    constexpr int kWidth = 160, kHeight = 120;
    TinyReader::read_next(cas, context);
    const types::SceneCas scene(cas);
    mapping::RgbdCamera camera;
    camera.depth = camera.color = {kWidth, kHeight, 150, 150, kWidth / 2.0, kHeight / 2.0};
    types::set_cameras(scene, camera);
    const cv::Rect box(70, 50, 20, 20);
    cv::Mat depth(kHeight, kWidth, CV_32F, cv::Scalar(1)),
        color(kHeight, kWidth, CV_8UC3, cv::Scalar(200, 200, 200)), points(kHeight, kWidth, CV_32FC3);
    depth(box).setTo(0.98);
    color(box).setTo(cv::Scalar(20, 20, 200));
    for (int v = 0; v < kHeight; ++v)
      for (int u = 0; u < kWidth; ++u)
        points.at<cv::Vec3f>(v, u) = point_at(camera.depth, u, v, depth.at<float>(v, u));
    if (taken) points(box).setTo(cv::Scalar::all(std::numeric_limits<double>::quiet_NaN()));
    types::set_view_image(scene, types::SceneCas::kDepth, depth);
    types::set_view_image(scene, types::SceneCas::kColor, color);
    set_cloud_points(scene, points);
    set_cloud_normals(scene, cv::Mat(kHeight, kWidth, CV_32FC3, cv::Scalar(0, 0, -1)));
    for (const types::PlanarSupport& support : scene.supports())
      support.outline.set(types::values_from_points(
          {{-0.45, -0.35, 1}, {0.45, -0.35, 1}, {0.45, 0.35, 1}, {-0.45, 0.35, 1}}));
  }

 private:
  static cv::Vec3f point_at(const mapping::PinholeCamera& camera, int u, int v, float z) {
    const Eigen::Vector3f p = camera.unproject(u, v, static_cast<double>(z)).cast<float>();
    return {p.x(), p.y(), p.z()};
  }
};

template <class Box>
size_t clusters_of() {
  AnnotatorRegistry registry;
  add_annotators(registry);
  registry.add_reader<Box>();
  Pipeline pipeline =
      Pipeline::parse("reader: TinyReader\nflow:\n  - FlatObjectExtractor\n", "test", registry);
  Resources resources;
  Warnings warnings;
  NoProgress progress;
  Context context{resources, warnings, 1, {}};
  size_t clusters = 0;
  pipeline.run(context, types::type_system(), progress, [&](cas::Cas& cas) {
    for (const types::Cluster& cluster : types::SceneCas(cas).clusters())
      clusters += cluster_indices(cluster).empty() ? 0 : 1;
  });
  return clusters;
}

TEST(FlatObjectExtractor, FindsNothingWhereThePointsAreTakenOut) {
  EXPECT_EQ(clusters_of<ThinBox<false>>(), 1U);
  EXPECT_EQ(clusters_of<ThinBox<true>>(), 0U) << "a person is not an object";
}

}  // namespace
}  // namespace loci::perception
