#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "apps/evaluate/mesh/comparison.h"
#include "mapping/base/temporary_folder.h"
#include "mapping/recording/recording.h"

namespace loci::apps::mesh_claim {
namespace {

/// A wall before a camera that goes sideways; the frames that judge see it `offset_m` farther.
std::filesystem::path wall(const std::filesystem::path& folder, double offset_m, bool posed = true) {
  mapping::RgbdCamera camera;
  camera.depth = camera.color = {160, 120, 140, 140, 80, 60};
  mapping::RecordingWriter writer(folder / "wall", camera, "map");
  for (int i = 0; i < 12; ++i) {
    mapping::RgbdFrame frame;
    frame.index = i;
    frame.time_ns = (i + 1) * kSecond;
    frame.camera = camera;
    frame.depth = cv::Mat(120, 160, CV_32F, cv::Scalar(1.2 + (i % 2) * offset_m));
    frame.color = cv::Mat(120, 160, CV_8UC3, cv::Scalar(90, 120, 150));
    if (posed) frame.map_from_camera = Isometry3d(Eigen::Translation3d(0.02 * i, 0, 0));
    writer.add(frame);
  }
  writer.finish();
  return folder / "wall";
}

Row row_of(const std::filesystem::path& recording) {
  NoProgress progress;
  Warnings warnings;
  const std::vector<Row> rows = compare_meshes(recording, {}, progress, warnings);
  EXPECT_EQ(rows.size(), 1U);
  return rows.front();
}

TEST(MeshFigures, FramesThatWereLeftOutJudge) {
  const TemporaryFolder folder("mesh");
  const Row same = row_of(wall(folder.path(), 0));
  EXPECT_EQ(same.frames, 6U);
  EXPECT_FALSE(same.vertex) << "nobody knows the true surface";
  EXPECT_GT(same.covered, 0.9);
  EXPECT_LT(same.depth_median_m, 0.002);
  EXPECT_EQ(same.before, 0);
  EXPECT_THAT(to_text({same}), testing::HasSubstr("loci"));
}

TEST(MeshFigures, WhatIsElsewhereIsNotCovered) {
  const TemporaryFolder folder("mesh");
  const Row beside = row_of(wall(folder.path(), 0.02));
  EXPECT_NEAR(beside.depth_median_m, 0.02, 0.003);
  const TemporaryFolder other("mesh");
  const Row far = row_of(wall(other.path(), 0.1));
  EXPECT_EQ(far.covered, 0);
  EXPECT_GT(far.before, 0.9);
}

TEST(MeshFigures, NeedPoses) {
  const TemporaryFolder folder("mesh");
  EXPECT_THROW(row_of(wall(folder.path(), 0, false)), Error);
}

}  // namespace
}  // namespace loci::apps::mesh_claim
