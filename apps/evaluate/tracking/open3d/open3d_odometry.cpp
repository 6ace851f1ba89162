// The module loci_open3d.so: loaded when its odometry is compared, because Open3D brings dozens of libraries.

#include <open3d/camera/PinholeCameraIntrinsic.h>
#include <open3d/geometry/RGBDImage.h>
#include <open3d/pipelines/odometry/Odometry.h>

#include <cstring>
#include <opencv2/imgproc.hpp>

#include "apps/evaluate/tracking/frame_odometry.h"

namespace loci::apps::tracking_evaluation {
namespace {

using open3d::geometry::Image;
using open3d::geometry::RGBDImage;

Image image_of(const cv::Mat& mat) {
  Image image;
  image.Prepare(mat.cols, mat.rows, mat.channels(), static_cast<int>(mat.elemSize1()));
  for (int v = 0; v < mat.rows; ++v)
    std::memcpy(image.data_.data() + static_cast<size_t>(v) * static_cast<size_t>(image.BytesPerLine()),
                mat.ptr(v), static_cast<size_t>(image.BytesPerLine()));
  return image;
}

class Open3dOdometry : public FrameOdometry {
 public:
  explicit Open3dOdometry(const mapping::PinholeCamera& camera)
      : camera_(camera.width, camera.height, camera.fx, camera.fy, camera.cx, camera.cy) {}

  std::optional<Isometry3d> add(const mapping::RgbdFrame& frame) override {
    cv::Mat rgb, depth = frame.depth.clone();
    cv::cvtColor(color_in_depth(frame), rgb, cv::COLOR_BGR2RGB);
    cv::patchNaNs(depth, 0);
    const auto now = RGBDImage::CreateFromColorAndDepth(image_of(rgb), image_of(depth), 1.0, 4.0, true);
    const auto before = std::exchange(before_, now);
    if (!before) return Isometry3d::Identity();
    const auto [found, motion, information] = open3d::pipelines::odometry::ComputeRGBDOdometry(
        *now, *before, camera_, Eigen::Matrix4d::Identity(),
        open3d::pipelines::odometry::RGBDOdometryJacobianFromHybridTerm());
    if (!found) return std::nullopt;
    Isometry3d before_from_now = Isometry3d::Identity();
    before_from_now.matrix() = motion;
    return before_from_now;
  }

 private:
  open3d::camera::PinholeCameraIntrinsic camera_;
  std::shared_ptr<RGBDImage> before_;
};

}  // namespace
}  // namespace loci::apps::tracking_evaluation

extern "C" loci::apps::tracking_evaluation::FrameOdometry* loci_open3d_odometry(
    const loci::mapping::PinholeCamera& camera) {
  return new loci::apps::tracking_evaluation::Open3dOdometry(camera);
}
