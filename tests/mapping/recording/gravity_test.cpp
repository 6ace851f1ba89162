#include "mapping/recording/gravity.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <opencv2/core.hpp>

#include "mapping/base/math/math.h"
#include "mapping/recording/posed_recording.h"

namespace loci::mapping {
namespace {

namespace fs = std::filesystem;

TEST(Up, OfAKitchenIsFoundHoweverItsWorldIsTurned) {
  const fs::path folder = fs::path(LOCI_SHARED_DIR) / "data/redkitchen_rgbd/frames";
  if (!fs::exists(folder)) GTEST_SKIP() << "no shared data";
  const auto level = find_up(*open_recording(folder));
  ASSERT_TRUE(level);
  EXPECT_GT(level->z(), 0.98);
  for (const Vector3d& axis : {Vector3d(1, 0, 0), Vector3d(0, 0.6, 0.8)}) {
    const Isometry3d turned(Eigen::AngleAxisd(kPi / 2 + 0.2, axis));
    const auto up = find_up(*in_frame(open_recording(folder), turned, "world"));
    ASSERT_TRUE(up);
    EXPECT_GT(up->dot(turned.linear() * Vector3d::UnitZ()), 0.98);
  }
}

/// A recording whose camera is held turned by quarter turns.
class Turned : public Recording {
 public:
  Turned(std::unique_ptr<Recording> recording, cv::RotateFlags turn)
      : recording_(std::move(recording)), turn_(turn) {
    info_ = recording_->info();
    info_.frames_with_pose = 0;
  }
  const RecordingInfo& info() const override { return info_; }
  size_t size() const override { return recording_->size(); }
  TimeNs time_of(size_t i) const override { return recording_->time_of(i); }
  int64_t index_of(size_t i) const override { return recording_->index_of(i); }
  RgbdFrame frame(size_t i) const override {
    RgbdFrame frame = recording_->frame(i);
    frame.map_from_camera.reset();
    cv::rotate(frame.depth, frame.depth, turn_);
    PinholeCamera& camera = frame.camera.depth;
    const PinholeCamera was = camera;
    if (turn_ != cv::ROTATE_180) camera = {was.height, was.width, was.fy, was.fx, was.cy, was.cx};
    if (turn_ == cv::ROTATE_180 || turn_ == cv::ROTATE_90_CLOCKWISE) camera.cx = camera.width - 1 - camera.cx;
    if (turn_ == cv::ROTATE_180 || turn_ == cv::ROTATE_90_COUNTERCLOCKWISE)
      camera.cy = camera.height - 1 - camera.cy;
    return frame;
  }

 private:
  std::unique_ptr<Recording> recording_;
  cv::RotateFlags turn_;
  RecordingInfo info_;
};

TEST(Up, OfACameraThatIsHeldSidewaysOrUpsideDownIsSeenByTheTable) {
  const fs::path folder = fs::path(LOCI_SHARED_DIR) / "data/osd_tabletop";
  if (!fs::exists(folder)) GTEST_SKIP() << "no shared data";
  const std::vector<std::pair<cv::RotateFlags, Vector3d>> turns = {
      {cv::ROTATE_90_CLOCKWISE, Vector3d::UnitX()},
      {cv::ROTATE_90_COUNTERCLOCKWISE, -Vector3d::UnitX()},
      {cv::ROTATE_180, Vector3d::UnitY()}};
  for (const auto& [turn, up] : turns) {
    const auto found = find_up(Turned(open_recording(folder), turn));
    ASSERT_TRUE(found) << turn;
    EXPECT_GT(found->dot(up), 0.5) << turn << ": " << found->transpose();
  }
}

/// A camera that pans and nods in a room of which it sees walls only, in a frame where `up` is up.
class WallsOnly : public Recording {
 public:
  explicit WallsOnly(const Eigen::Matrix3d& turn) : turn_(turn) {
    info_.camera.depth = {160, 120, 146, 146, 79.5, 59.5};
    info_.frames = info_.frames_with_pose = 60;
  }
  const RecordingInfo& info() const override { return info_; }
  size_t size() const override { return info_.frames; }
  TimeNs time_of(size_t i) const override { return static_cast<TimeNs>(i) * kSecond; }
  int64_t index_of(size_t i) const override { return static_cast<int64_t>(i); }
  RgbdFrame frame(size_t i) const override {
    const auto t = static_cast<double>(i);
    const double pan = 0.4 + 0.03 * t, tilt = -0.4 + 0.25 * std::sin(t / 4);
    const Vector3d forward(std::cos(pan) * std::cos(tilt), std::sin(pan) * std::cos(tilt), std::sin(tilt)),
        right(std::sin(pan), -std::cos(pan), 0);
    Eigen::Matrix3d room_from_camera;
    room_from_camera << right, forward.cross(right), forward;
    RgbdFrame frame;
    frame.camera = info_.camera;
    frame.depth = cv::Mat1f(120, 160, std::numeric_limits<float>::quiet_NaN());
    for (int v = 0; v < 120; ++v)
      for (int u = 0; u < 160; ++u) {
        const Vector3d ray = room_from_camera * info_.camera.depth.unproject(u, v, 1);
        const double x = (ray.x() > 0 ? 2.2 : -1.8) / ray.x(), y = (ray.y() > 0 ? 1.4 : -1.9) / ray.y(),
                     depth = std::min(x, y);
        if (1.5 + depth * ray.z() > 0) frame.depth.at<float>(v, u) = static_cast<float>(depth);
      }
    frame.map_from_camera = Isometry3d(turn_ * room_from_camera);
    return frame;
  }

 private:
  Eigen::Matrix3d turn_;
  RecordingInfo info_;
};

TEST(Up, IsKnownFromHowACameraTurnedWhereNoFloorIsInView) {
  for (const Vector3d& axis : {Vector3d(1, 0, 0), Vector3d(0, 0.6, 0.8), Vector3d(0.6, 0.8, 0)}) {
    const Eigen::Matrix3d turn = Eigen::AngleAxisd(1.9, axis).toRotationMatrix();
    const auto up = find_up(WallsOnly(turn));
    ASSERT_TRUE(up);
    EXPECT_GT(up->dot(turn * Vector3d::UnitZ()), 0.9998) << axis.transpose();
  }
}

TEST(Up, DirectionsAreReadStrictly) {
  EXPECT_EQ(parse_direction("-y"), Vector3d(0, -1, 0));
  EXPECT_TRUE(parse_direction("0, -2,0").isApprox(Vector3d(0, -1, 0)));
  for (const char* text : {"", "up", "1,2", "0,0,0", "1,2,x", "nan,0,0"})
    EXPECT_THROW(parse_direction(text), Error) << text;
}

}  // namespace
}  // namespace loci::mapping
