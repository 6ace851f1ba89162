#include "mapping/fusion/fusion.h"
#include "mapping/base/math/math.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "mapping/base/math/random.h"
#include "mapping/fusion/room_mesh.h"

namespace loci::mapping {
namespace {

constexpr float kNoDepth = std::numeric_limits<float>::quiet_NaN();

/// A camera that looks straight down at a floor with a box on it, from a slightly different place each frame.
class SmallRecording : public Recording {
 public:
  explicit SmallRecording(size_t frames) {
    info_.path = "small";
    info_.map_frame = "map";
    info_.frames = frames;
    info_.camera.depth = {160, 120, 140, 140, 80, 60};
    info_.camera.color = info_.camera.depth;
    info_.camera.depth_from_color.translation().x() = 0.03;
  }

  const RecordingInfo& info() const override { return info_; }
  size_t size() const override { return info_.frames; }
  TimeNs time_of(size_t i) const override { return static_cast<TimeNs>(i) * kSecond; }
  int64_t index_of(size_t i) const override { return static_cast<int64_t>(i); }

  RgbdFrame frame(size_t i) const override {
    RgbdFrame frame;
    frame.camera = info_.camera;
    frame.depth = cv::Mat(120, 160, CV_32F, cv::Scalar(kNoDepth));
    const double bright = i % 2 == 1 ? brightness_of_odd_frames_ : 1;
    frame.color = cv::Mat(120, 160, CV_8UC3, cv::Scalar(20 * bright, 40 * bright, 120 * bright));
    Isometry3d pose = Isometry3d::Identity();
    pose.linear() = Eigen::AngleAxisd(kPi, Vector3d::UnitX()).toRotationMatrix();
    pose.translation() = Vector3d(0.01 * static_cast<double>(i), 0, 1.5);
    Random random = Random(7).fork(i);
    for (int v = 0; v < 120; ++v)
      for (int u = 0; u < 160; ++u) {
        const Vector3d top = pose * frame.camera.depth.unproject(u, v, 1.3);
        const bool box = i < box_until_ && std::abs(top.x()) < 0.2 && std::abs(top.y()) < 0.2;
        frame.depth.at<float>(v, u) = static_cast<float>((box ? 1.3 : 1.5) + random.normal(0.002));
      }
    if (i < color_damaged_) {
      frame.color.release();
      frame.damage = fmt::format("{}.jpg: the image is damaged", i);
    }
    if (i < without_pose_) return frame;
    frame.map_from_camera = pose;
    return frame;
  }

  RecordingInfo info_;
  size_t without_pose_ = 0;
  size_t color_damaged_ = 0;
  size_t box_until_ = 1000;  ///< then it is taken away
  double brightness_of_odd_frames_ = 1;
};

FusionResult fused(const Recording& recording, FusionOptions options = {}) {
  NoProgress progress;
  return fuse(recording, options, progress);
}

TEST(Fusion, FloorAndBoxStandAtTheirHeights) {
  const FusionResult result = fused(SmallRecording(10));
  double floor = 0, top = 0;
  size_t floor_points = 0, top_points = 0;
  for (const Scan& scan : result.scans.scans)
    for (const ScanPoint& point : scan.points) {
      const Vector3d at = scan.map_from_scan * point.position.cast<double>();
      const bool is_top = at.z() > 0.1;
      (is_top ? top : floor) += at.z();
      ++(is_top ? top_points : floor_points);
    }
  ASSERT_GT(floor_points, 1000U);
  ASSERT_GT(top_points, 200U);
  EXPECT_NEAR(floor / static_cast<double>(floor_points), 0, 0.002);
  EXPECT_NEAR(top / static_cast<double>(top_points), 0.2, 0.002);
}

TEST(Fusion, FramesWithoutPoseAreLeftOutAndCounted) {
  SmallRecording recording(10);
  recording.without_pose_ = 4;
  const FusionResult result = fused(recording);
  EXPECT_EQ(result.frames.used(), 6U);
  EXPECT_EQ(result.frames.count(Reason::no_pose), 4U);
  EXPECT_EQ(result.frames.reasons(), "no pose of the camera in 4");
  EXPECT_THAT(result.summary(), testing::StartsWith("6 frames became 1 scan with "));
}

TEST(Fusion, ColourThatCannotBeReadIsCounted) {
  SmallRecording recording(10);
  recording.color_damaged_ = 3;
  const FusionResult result = fused(recording);
  EXPECT_EQ(result.frames.used(), 10U);
  EXPECT_EQ(result.without_color.reasons(),
            "an image that cannot be read in 3 (0.jpg: the image is damaged)");
}

TEST(Fusion, RefusesARecordingWithoutAnyPoseWithTheReason) {
  SmallRecording recording(3);
  recording.without_pose_ = 3;
  try {
    fused(recording);
    FAIL() << "fused";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("no pose of the camera in 3; give it poses"));
  }
}

TEST(Fusion, RefusesFreeSpaceAlone) {
  FusionOptions options;
  options.range_max_m = 0.6;
  EXPECT_THROW(fused(SmallRecording(5), options), Error);
}

TEST(Fusion, ConsecutiveFramesBecomeScansWithTheirOrigins) {
  FusionOptions options;
  options.frames_per_scan = 4;
  const FusionResult result = fused(SmallRecording(10), options);
  ASSERT_EQ(result.scans.scans.size(), 3U);
  EXPECT_EQ(result.scans.scans[0].origins.size(), 4U);
  EXPECT_EQ(result.scans.scans[2].origins.size(), 2U);
  const Scan& last = result.scans.scans[2];
  EXPECT_NEAR((last.map_from_scan * last.origins[1].cast<double>()).x(), 0.09, 1e-5);
}

TEST(Fusion, WhatFewFramesSawIsLeftOut) {
  FusionOptions options;
  options.min_observations = 8;
  EXPECT_LT(fused(SmallRecording(10), options).points(), fused(SmallRecording(10)).points());
}

TEST(Fusion, BeyondTheRangeOnlyFreeSpaceIsKept) {
  FusionOptions options;
  options.range_max_m = 1.4;
  const FusionResult result = fused(SmallRecording(5), options);
  size_t free = 0;
  for (const ScanPoint& point : result.scans.scans[0].points) {
    if (point.returned) continue;
    ++free;
    EXPECT_NEAR(point.position.z(), 1.4F, 1e-3F);
  }
  EXPECT_GT(free, 20U);
}

TEST(Fusion, ColourComesFromTheColourCamera) {
  const FusionResult result = fused(SmallRecording(4));
  for (const ScanPoint& point : result.scans.scans[0].points)
    if (point.r != 0) {
      EXPECT_EQ(point.r, 120);
      EXPECT_EQ(point.b, 20);
    }
}

TEST(Fusion, SameScansOnOneAndTwoThreads) {
  FusionOptions options;
  options.frames_per_scan = 3;
  options.threads = 1;
  const FusionResult one = fused(SmallRecording(11), options);
  options.threads = 2;
  const FusionResult two = fused(SmallRecording(11), options);
  ASSERT_EQ(one.scans.scans.size(), two.scans.scans.size());
  for (size_t i = 0; i < one.scans.scans.size(); ++i) {
    const auto& a = one.scans.scans[i].points;
    const auto& b = two.scans.scans[i].points;
    ASSERT_EQ(a.size(), b.size());
    for (size_t k = 0; k < a.size(); ++k) ASSERT_EQ(a[k].position, b[k].position);
  }
}

TEST(Fusion, FlyingPixelsAreDropped) {
  cv::Mat depth(20, 20, CV_32F, cv::Scalar(2.0));
  depth.colRange(0, 10) = 1.0;
  depth.col(10) = 1.5;  // between foreground and background
  cv::Mat lone = depth.clone();
  lone.at<float>(5, 5) = 1.2F;
  EXPECT_GE(drop_flying_pixels(depth), 18U);
  EXPECT_TRUE(std::isnan(depth.at<float>(10, 10)));
  EXPECT_FALSE(std::isnan(depth.at<float>(10, 9)));
  EXPECT_FALSE(std::isnan(depth.at<float>(10, 11)));
  drop_flying_pixels(lone);
  EXPECT_TRUE(std::isnan(lone.at<float>(5, 5)));
}

RoomMesh meshed(const Recording& recording, MeshOptions options = {}, int threads = 0) {
  NoProgress progress;
  FusionOptions fusion;
  fusion.threads = threads;
  return mesh_room(recording, fusion, options, progress);
}

/// At the border the colour camera does not see what the depth camera does.
constexpr std::array<uint8_t, 3> kUnseenColor = {160, 160, 160};

TEST(RoomMesh, SurfacesLieWhereTheyAreLookAtTheCameraAndHaveTheirColor) {
  const ColoredMesh mesh = meshed(SmallRecording(10)).mesh;
  double top_area = 0;
  for (const auto& triangle : mesh.triangles) {
    const Eigen::Vector3f a = mesh.positions[triangle[0]], b = mesh.positions[triangle[1]],
                          c = mesh.positions[triangle[2]];
    const Eigen::Vector3f across = (b - a).cross(c - a) / 2;
    if (std::min({a.z(), b.z(), c.z()}) < 0.19F) continue;
    EXPECT_GT(across.z(), 0) << "seen from above";
    top_area += static_cast<double>(across.z());
  }
  EXPECT_NEAR(top_area, 0.16, 0.016) << "the box's top";
  size_t floor = 0;
  for (size_t i = 0; i < mesh.positions.size(); ++i) {
    const Eigen::Vector3f& at = mesh.positions[i];
    if (std::abs(at.x()) < 0.25F && std::abs(at.y()) < 0.25F) continue;
    EXPECT_NEAR(at.z(), 0, 0.004);
    if (mesh.colors[i] == kUnseenColor) continue;
    EXPECT_NEAR(mesh.colors[i][0], 120, 1);
    EXPECT_NEAR(mesh.colors[i][2], 20, 1);
    ++floor;
  }
  EXPECT_GT(floor, 3000U);
}

TEST(RoomMesh, ExposureOfFramesIsMatched) {
  SmallRecording recording(10);
  recording.brightness_of_odd_frames_ = 1.5;
  const ColoredMesh mesh = meshed(recording).mesh;
  ASSERT_FALSE(mesh.colors.empty());
  for (const auto& color : mesh.colors) EXPECT_NEAR(color == kUnseenColor ? 120 : color[0], 120, 3);
}

TEST(RoomMesh, WhatWasTakenAwayIsCleared) {
  SmallRecording recording(40);
  recording.box_until_ = 10;
  for (const Eigen::Vector3f& at : meshed(recording).mesh.positions) EXPECT_LT(at.z(), 0.1F);
}

TEST(RoomMesh, LittleMemoryGivesLargerVoxels) {
  MeshOptions options;
  options.mesh_voxel_m = 0.0025;
  options.mesh_memory_mb = 16;
  const RoomMesh room = meshed(SmallRecording(10), options);
  EXPECT_GT(room.voxel_m, 0.0045);
  ASSERT_FALSE(room.mesh.positions.empty());
  for (const Eigen::Vector3f& at : room.mesh.positions) {
    const bool is_near_box = std::abs(at.x()) < 0.3F && std::abs(at.y()) < 0.3F;
    EXPECT_NEAR(is_near_box ? 0 : at.z(), 0, 0.006);
  }
}

TEST(RoomMesh, OptionsOutOfBoundsAreRefused) {
  MeshOptions options;
  options.mesh_memory_mb = -1;
  EXPECT_THROW(meshed(SmallRecording(2), options), Error);
}

TEST(RoomMesh, SameMeshOnAnyNumberOfThreads) {
  const ColoredMesh a = meshed(SmallRecording(10), {}, 1).mesh, b = meshed(SmallRecording(10), {}, 3).mesh;
  EXPECT_EQ(a.positions, b.positions);
  EXPECT_EQ(a.colors, b.colors);
  EXPECT_EQ(a.triangles, b.triangles);
}

}  // namespace
}  // namespace loci::mapping
