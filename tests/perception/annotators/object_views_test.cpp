#include "perception/annotators/description/object_views.h"
#include "mapping/base/math/math.h"

#include <gmock/gmock.h>

#include "perception/annotators/description/geometry_annotators.h"
#include "perception/annotators/scene_data.h"
#include "perception/conversions/opencv.h"
#include "perception/pipeline/pipeline.h"

namespace loci::perception {
namespace {

using ::testing::HasSubstr;

constexpr double kWide = 0.3, kDeep = 0.2, kHigh = 0.1;

/// Two boxes on a table, 1 m apart, seen from the front, the right, the back and the front again; each camera
/// sees only those sides that face it. Boxes and camera stand upright.
class Carousel : public Reader {
 public:
  AnnotatorDescriptor descriptor() const override {
    return {"RecordingReader",
            "Two boxes from all sides.",
            {},
            {"Scene", "CameraInfo", "Cluster", "ReferenceClusterPoints", "PlanarSupport", "view:cloud",
             "view:normals"}};
  }
  void start(Context&) override {}
  size_t count() const override { return 4; }
  size_t position() const override { return position_; }
  FrameId upcoming() const override { return {static_cast<int64_t>(position_), 0}; }
  void skip(size_t frames) override { position_ += frames; }

  void read_next(cas::Cas& cas, Context&) override {
    const types::SceneCas scene(cas);
    const types::Scene made = scene.create_scene();
    made.frame_index.set(upcoming().index);
    Isometry3d map_from_camera(
        Eigen::AngleAxisd(kPi / 2 * static_cast<double>(position_ % 3), Vector3d::UnitZ()));
    map_from_camera.translation() = map_from_camera.linear() * Vector3d(0, -2, 0.5);
    made.map_from_camera.set(types::to_stamped(cas, map_from_camera, "map", "depth_camera", 0));
    const auto support = types::PlanarSupport::create(cas);
    support.name.set("table_1");
    support.normal.set(types::to(cas, Vector3d(0, 0, 1)));
    support.offset.set(0);
    support.map_from_support.set(types::to(cas, Isometry3d::Identity()));
    scene.add_support(support);
    std::vector<cv::Vec3f> points, normals;
    std::vector<std::vector<int32_t>> indices;
    for (const double x : {-0.5, 0.5}) {
      indices.emplace_back();
      add_sides(Vector3d(x, 0, 0), map_from_camera, points, normals, indices.back());
    }
    set_cloud_points(scene, cv::Mat(points, true).reshape(3, 1));
    set_cloud_normals(scene, cv::Mat(normals, true).reshape(3, 1));
    for (const auto& its : indices) {
      const auto cluster = types::Cluster::create(cas);
      cluster.support.set(support);
      cluster.centroid.set(types::to(cas, Vector3d(0, 0, 0)));
      const auto reference = types::ReferenceClusterPoints::create(cas);
      reference.cloud.set(scene.cloud());
      reference.indices.get_or_create().indices.set(its);
      cluster.hypotheses.push_back(reference);
      scene.add_cluster(cluster);
    }
    ++position_;
  }

 private:
  static void add_sides(const Vector3d& foot, const Isometry3d& map_from_camera,
                        std::vector<cv::Vec3f>& points, std::vector<cv::Vec3f>& normals,
                        std::vector<int32_t>& indices) {
    const Isometry3d camera_from_map = map_from_camera.inverse();
    for (int i = -10; i <= 10; ++i)
      for (int j = 0; j <= 10; ++j)
        for (const int side : {0, 1, 2, 3}) {
          const double s = side % 2 == 0 ? -1 : 1, t = i / 10.0, z = kHigh * j / 10;
          const Vector3d normal = side < 2 ? Vector3d(0, s, 0) : Vector3d(s, 0, 0);
          const Vector3d point = foot + (side < 2 ? Vector3d(t * kWide / 2, s * kDeep / 2, z)
                                                  : Vector3d(s * kWide / 2, t * kDeep / 2, z));
          // Only what faces the camera squarely, as if the rest were too oblique.
          if (normal.dot(
                  (map_from_camera.translation() - foot).cwiseProduct(Vector3d(1, 1, 0)).normalized()) < 0.9)
            continue;
          const auto as_vec = [](const Vector3d& v) {
            return cv::Vec3f(static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z()));
          };
          indices.push_back(static_cast<int32_t>(points.size()));
          points.push_back(as_vec(camera_from_map * point));
          normals.push_back(as_vec(camera_from_map.linear() * normal));
        }
  }
  size_t position_ = 0;
};

struct Box {
  Vector3d size;
  int views = 0;
};

/// The boxes of every scene, after `flow`.
std::vector<std::vector<Box>> boxes(const std::string& flow) {
  AnnotatorRegistry registry;
  registry.add_reader<Carousel>();
  registry.add<GeometryAnnotator>();
  registry.add_multiplier<ObjectViews>();
  Pipeline pipeline = Pipeline::parse(flow, "p.yaml", registry);
  Resources resources;
  Warnings warnings;
  Context context{resources, warnings, 1, {}};
  NoProgress progress;
  std::vector<std::vector<Box>> found;
  pipeline.run(context, types::type_system(), progress, [&](cas::Cas& cas) {
    auto& scene = found.emplace_back();
    for (const types::Cluster& cluster : types::SceneCas(cas).clusters()) {
      const auto geometry = cluster.annotations.first<types::GeometryAnnotation>();
      ASSERT_TRUE(geometry);
      EXPECT_EQ(cluster.annotations.size(), 1U);
      EXPECT_EQ(geometry.place.get(), "table_1");
      scene.push_back({types::from<Vector3d>(geometry.size.get()), geometry.views.get()});
    }
  });
  return found;
}

TEST(ObjectViews, MeasureWhatNoSingleImageShows) {
  const auto alone = boxes("flow: [GeometryAnnotator]");
  EXPECT_LT(alone[0][0].size.y(), 0.01) << "the front alone has no depth";
  const auto found = boxes("flow: [{multiply: {ObjectViews: {place_m: 0.2}}, do: [GeometryAnnotator]}]");
  ASSERT_EQ(found.size(), 4U);
  EXPECT_EQ(found[0][0].views, 0) << "one view is no merit";
  EXPECT_LT(found[0][0].size.y(), 0.01);
  EXPECT_GT(found[1][0].size.y(), 0.1) << "front and side";
  for (const size_t scene : {2U, 3U})
    for (const Box& box : found[scene]) {
      EXPECT_NEAR(box.size.x(), kWide, 0.01) << scene;
      EXPECT_NEAR(box.size.y(), kDeep, 0.02) << scene;
      EXPECT_NEAR(box.size.z(), kHigh, 0.01) << scene;
    }
  EXPECT_EQ(found[1][0].views, 2);
  EXPECT_EQ(found[2][0].views, 3);
  EXPECT_EQ(found[3][0].views, 3) << "a view from the same side replaces the older one";
}

TEST(ObjectViews, AsManyAreKeptAsAskedFor) {
  const auto found =
      boxes("flow: [{multiply: {ObjectViews: {last: 2, place_m: 0.2}}, do: [GeometryAnnotator]}]");
  EXPECT_EQ(found[2][1].views, 2);
}

TEST(ObjectViews, OneByOneTheyAreClustersOfTheirOwn) {
  // The newest view alone is measured for the scene; the others' annotations stay with them.
  const auto found =
      boxes("flow: [{multiply: {ObjectViews: {as: views, place_m: 0.2}}, do: [GeometryAnnotator]}]");
  EXPECT_LT(found[2][0].size.y(), 0.01);
  EXPECT_EQ(found[2][0].views, 0);
}

TEST(ObjectViews, WhatCannotBeBroughtBackIsRefused) {
  try {
    boxes("flow: [{multiply: ObjectVews, do: [GeometryAnnotator]}]");
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("there is no CAS multiplier 'ObjectVews'"));
    EXPECT_THAT(error.what(), HasSubstr("ObjectViews"));
  }
}

}  // namespace
}  // namespace loci::perception
