// A box on a table that is seen from several sides, and what its views add up to.

#include "memory/exchange/object_model.h"
#include "mapping/base/math/math.h"

#include <gmock/gmock.h>

#include <cmath>

#include "mapping/base/text/json.h"
#include "mapping/image/image_io.h"
#include "memory/exchange/observation_image.h"
#include "memory/store/scene_images.h"
#include "memory/store/scene_transaction.h"
#include "tests/memory/store/temporary_folder.h"

namespace loci::memory {
namespace {

constexpr int kWidth = 160, kHeight = 120;
const SceneCamera kCamera{kWidth, kHeight, 150, 150, 79.5, 59.5, 0.1, 5.0};

class ObjectModelTest : public testing_support::TemporaryFolder {
 protected:
  /// Where a ray meets the box, if it does: the slab method.
  static std::optional<double> hit(const Vector3d& from, const Vector3d& along, const Vector3d& low,
                                   const Vector3d& high) {
    double enter = 0, leave = 1e9;
    for (int axis = 0; axis < 3; ++axis) {
      double a = (low[axis] - from[axis]) / along[axis], b = (high[axis] - from[axis]) / along[axis];
      if (a > b) std::swap(a, b);
      enter = std::max(enter, a);
      leave = std::min(leave, b);
    }
    return enter < leave && enter > 0 ? std::optional(enter) : std::nullopt;
  }

  static Isometry3d looking(const Vector3d& from, const Vector3d& at) {
    const Vector3d z = (at - from).normalized(), x = z.cross(Vector3d::UnitZ()).normalized();
    Isometry3d pose = Isometry3d::Identity();
    pose.linear() << x, z.cross(x), z;
    pose.translation() = from;
    return pose;
  }

  /// The box as it is seen from an angle; where it stands.
  void add_view(Store& store, Id run, double angle_deg, const Vector3d& centre, const std::string& word) {
    const double angle = angle_deg / 180 * kPi;
    const Isometry3d pose =
        looking(centre + Vector3d(0.6 * std::cos(angle), 0.6 * std::sin(angle), 0.4), centre);
    std::vector<float> depth(kWidth * kHeight, 0.0F);
    cv::Mat mask = cv::Mat::zeros(kHeight, kWidth, CV_8U);
    int64_t points = 0;
    for (int v = 0; v < kHeight; ++v)
      for (int u = 0; u < kWidth; ++u) {
        const Vector3d ray((u - kCamera.cx) / kCamera.fx, (v - kCamera.cy) / kCamera.fy, 1);
        const auto z = hit(pose.translation(), pose.linear() * ray, centre - kSize / 2, centre + kSize / 2);
        if (!z) continue;
        depth[static_cast<size_t>(v * kWidth + u)] = static_cast<float>(*z);
        mask.at<uint8_t>(v, u) = 255;
        ++points;
      }
    const auto png = mapping::encode_image(mask, ".png");
    SceneTransaction scene(store, run);
    const Id blob = scene.add_blob(encode_depth_thumbnail(depth), kDepthThumbnailMedia);
    const Id mask_blob = scene.add_blob({reinterpret_cast<const char*>(png.data()), png.size()}, "image/png");
    time_ += 60 * kSecond;
    const Id id = scene.add_scene({.time = time_,
                                   .camera = kCamera,
                                   .map_from_camera = pose,
                                   .depth = blob,
                                   .depth_width = kWidth,
                                   .depth_height = kHeight});
    ObservationRow row{.scene = id, .number = 0, .position = centre, .points = points, .crop = mask_blob};
    row.mask = mask_blob;
    row.roi = {0, 0, kWidth, kHeight};
    if (keep_points_) {
      std::vector<float> kept;
      for (size_t i = 0; i < depth.size(); ++i)
        if (mask.data[i] != 0) kept.push_back(depth[i] + kBehind);
      row.cloud = scene.add_blob(encode_cluster_depth(kept), kClusterDepthMedia);
    }
    const Id seen = scene.add_observation(row);
    if (!made_) scene.add_object({});
    made_ = true;
    scene.add_annotation({.scene = id, .observation = seen, .type = "loci.Text", .value = word});
    scene.add_association({.scene = id,
                           .observation = seen,
                           .object = 1,
                           .explanation = Explanation::stay,
                           .probability = 1,
                           .chosen = true});
    scene.add_belief(
        {.object = 1, .scene = id, .status = ObjectStatus::seen, .position = centre, .last_scene = id});
    scene.commit();
  }

  const Vector3d kSize{0.2, 0.12, 0.1};
  TimeNs time_ = kSecond;
  bool made_ = false;
  bool keep_points_ = false;  ///< of the cluster, told from those of the thumbnail by their depth
  static constexpr float kBehind = 0.05F;
};

TEST_F(ObjectModelTest, PointsOfTheClusterComeBeforeTheThumbnail) {
  keep_points_ = true;
  {
    Store store = Store::open_write(file_);
    add_view(store, store.begin_run("test", "{}"), 30, {1, 2, 0.8}, "tea");
  }
  const Store store = Store::open_read(file_);
  const SceneRow scene = store.scene(1);
  const std::optional<mapping::Scan> cloud = cloud_of(store, scene, store.observation(1));
  ASSERT_TRUE(cloud.has_value());
  EXPECT_EQ(cloud->points.size(), static_cast<size_t>(*store.observation(1).points));
  const auto thumbnail = DepthThumbnail::of(store, scene);
  for (const mapping::ScanPoint& point : cloud->points) {
    const Vector3d p = scene.map_from_camera->inverse() * point.position.cast<double>();
    const long u = std::lround(kCamera.fx * p.x() / p.z() + kCamera.cx),
               v = std::lround(kCamera.fy * p.y() / p.z() + kCamera.cy);
    ASSERT_NEAR(p.z(), thumbnail->depth()[static_cast<size_t>(v * kWidth + u)] + kBehind, 0.0015);
  }
}

TEST_F(ObjectModelTest, ViewsOfOneSpotLieOnTheBoxTogetherAndShowItsSides) {
  {
    Store store = Store::open_write(file_);
    const Id run = store.begin_run("test", "{}");
    for (const double angle : {30.0, 120.0, 210.0, 300.0})
      add_view(store, run, angle, {1, 2, 0.8}, angle < 300 ? "tea" : "coffee");
  }
  const Store store = Store::open_read(file_);
  NoProgress silent;
  const ObjectModel model = model_of(store, 1, {}, silent);
  ASSERT_EQ(model.views.size(), 4U);
  std::set<std::string> sides;
  for (const ObjectView& view : model.views) sides.insert(view.side);
  EXPECT_EQ(sides, (std::set<std::string>{"front", "left", "back", "right"}));
  EXPECT_EQ(model.best_crop.size(), 4U);
  size_t points = 0, off = 0;
  for (const mapping::Scan& scan : model.cloud.scans)
    for (const mapping::ScanPoint& point : scan.points) {
      const Vector3d p = scan.map_from_scan * point.position.cast<double>();
      const Vector3d outside = (p.cwiseAbs() - kSize / 2).cwiseMax(0.0);
      ++points;
      if (outside.norm() > 0.01) ++off;
    }
  EXPECT_GT(points, 2000U);
  EXPECT_LT(off, points / 20);
  ASSERT_EQ(model.evidence.size(), 2U);
  EXPECT_EQ(model.evidence[0].value, "tea");
  EXPECT_DOUBLE_EQ(model.evidence[0].agreement, 0.75);
}

TEST_F(ObjectModelTest, WhatCannotBeRegisteredSaysSo) {
  {
    Store store = Store::open_write(file_);
    const Id run = store.begin_run("test", "{}");
    add_view(store, run, 0, {1, 2, 0.8}, "tea");
    add_view(store, run, 180, {3, 2, 0.8}, "tea");  // elsewhere, from behind
  }
  const Store store = Store::open_read(file_);
  NoProgress silent;
  const ObjectModel model = model_of(store, 1, {}, silent);
  ASSERT_EQ(model.views.size(), 2U);
  EXPECT_NE(model.views[0].stay, model.views[1].stay);
  for (const ObjectView& view : model.views) {
    EXPECT_NE(view.placed, "");
    EXPECT_EQ(view.registered, view.placed.find("centre alone") == std::string::npos);
  }
  EXPECT_EQ(model.report()["views"].size(), 2U);
}

TEST_F(ObjectModelTest, ALabelImageHasTheNumbersOfTheObjectsWhereTheirMasksAre) {
  {
    Store store = Store::open_write(file_);
    add_view(store, store.begin_run("test", "{}"), 0, {1, 2, 0.8}, "tea");
  }
  const Store store = Store::open_read(file_);
  const cv::Mat labels = label_image(store, store.scene(1));
  ASSERT_EQ(labels.type(), CV_16U);
  EXPECT_EQ(labels.size(), cv::Size(kWidth, kHeight));
  EXPECT_EQ(labels.at<uint16_t>(kHeight / 2, kWidth / 2), 1);
  EXPECT_EQ(labels.at<uint16_t>(0, 0), 0);
  EXPECT_EQ(static_cast<int64_t>(cv::countNonZero(labels)), *store.observation(1).points);
}

TEST_F(ObjectModelTest, WithoutDepthThereIsNoModel) {
  {
    Store store = Store::open_write(file_);
    const Id run = store.begin_run("test", "{}");
    SceneTransaction scene(store, run);
    const Id id = scene.add_scene({.time = kSecond});
    const Id seen = scene.add_observation({.scene = id, .number = 0, .position = Vector3d(1, 2, 3)});
    scene.add_object({});
    scene.add_association({.scene = id,
                           .observation = seen,
                           .object = 1,
                           .explanation = Explanation::appear,
                           .probability = 1,
                           .chosen = true});
    scene.commit();
  }
  NoProgress silent;
  EXPECT_THROW(model_of(Store::open_read(file_), 1, {}, silent), Error);
}

}  // namespace
}  // namespace loci::memory
