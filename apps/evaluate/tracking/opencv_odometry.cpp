#include <opencv2/imgproc.hpp>
#include <opencv2/rgbd/depth.hpp>

#include "apps/evaluate/tracking/frame_odometry.h"

namespace loci::apps::tracking_evaluation {
namespace {

class OpencvOdometry : public FrameOdometry {
 public:
  explicit OpencvOdometry(const mapping::PinholeCamera& camera)
      : odometry_(cv::rgbd::RgbdICPOdometry::create(
            (cv::Mat_<float>(3, 3) << camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1))) {}

  std::optional<Isometry3d> add(const mapping::RgbdFrame& frame) override {
    cv::Mat gray, motion;
    cv::cvtColor(color_in_depth(frame), gray, cv::COLOR_BGR2GRAY);
    auto now = cv::makePtr<cv::rgbd::OdometryFrame>(gray, frame.depth);
    auto before = std::exchange(before_, now);
    if (before.empty()) return Isometry3d::Identity();
    if (!odometry_->compute(before, now, motion)) return std::nullopt;
    Isometry3d now_from_before = Isometry3d::Identity();
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 4; ++c) now_from_before(r, c) = motion.at<double>(r, c);
    return now_from_before.inverse();
  }

 private:
  cv::Ptr<cv::rgbd::RgbdICPOdometry> odometry_;
  cv::Ptr<cv::rgbd::OdometryFrame> before_;
};

}  // namespace

std::unique_ptr<FrameOdometry> opencv_odometry(const mapping::PinholeCamera& camera) {
  return std::make_unique<OpencvOdometry>(camera);
}

}  // namespace loci::apps::tracking_evaluation
