// The module loci_open3d.so: loaded when Open3D is compared, because it brings dozens of libraries.

#include <open3d/pipelines/odometry/Odometry.h>

#include "apps/evaluate/open3d/image.h"
#include "apps/evaluate/tracking/frame_odometry.h"

namespace loci::apps::tracking_evaluation {
namespace {

class Open3dOdometry : public FrameOdometry {
 public:
  explicit Open3dOdometry(const mapping::PinholeCamera& camera)
      : camera_(open3d_peer::intrinsic_of(camera)) {}

  std::optional<Isometry3d> add(const mapping::RgbdFrame& frame) override {
    const auto now = open3d_peer::rgbd_of(frame, 4.0, true);
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
  std::shared_ptr<open3d::geometry::RGBDImage> before_;
};

}  // namespace
}  // namespace loci::apps::tracking_evaluation

extern "C" loci::apps::tracking_evaluation::FrameOdometry* loci_open3d_odometry(
    const loci::mapping::PinholeCamera& camera) {
  return new loci::apps::tracking_evaluation::Open3dOdometry(camera);
}
