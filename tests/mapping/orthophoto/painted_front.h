#pragma once

#include <cmath>
#include <functional>
#include <limits>
#include <utility>
#include <vector>

#include "mapping/base/math/math.h"
#include "mapping/base/math/random.h"
#include "mapping/interpretation/fronts/furniture_face.h"
#include "mapping/recording/recording.h"

namespace loci::mapping {

/// A plane x = 0, seen from +x, painted with furniture: u = y, v = z. Handles are bars before it.
struct PaintedFront {
  struct Bar {
    double u0, u1, v0, v1, depth;
  };
  std::vector<Bar> bars;
  std::vector<double> upright_seams;  ///< u, 4 mm wide, between v 0.15 and 0.85
  std::vector<double> level_seams;    ///< v, over the whole width
  double u_min = -0.6, u_max = 0.6;
  double roll = 0;  ///< by which the paint leans, radians
  double side = 0;  ///< by which the camera is to the right of the middle, metres
  double step = 0;  ///< by which the right half is before the left one, metres

  cv::Vec3b color(double u, double v) const {
    const Vector2d turned = Eigen::Rotation2Dd(-roll) * Vector2d(u, v - 0.5) + Vector2d(0, 0.5);
    u = turned.x();
    v = turned.y();
    if (v > 0.85) return {60, 60, 60};     // counter
    if (v < 0.15) return {170, 170, 160};  // plinth
    if (u < u_min || u > u_max) return {220, 225, 220};
    for (const double seam : upright_seams)
      if (std::abs(u - seam) < 0.002) return {20, 20, 60};
    for (const double seam : level_seams)
      if (std::abs(v - seam) < 0.002) return {20, 20, 60};
    return {40, 50, 150};
  }
};

/// Frames of a hand-held depth camera before a painted plane, with noise, and drift in odd frames.
class PaintedRecording : public Recording {
 public:
  explicit PaintedRecording(PaintedFront front) : front_(std::move(front)) {
    info_.path = "painted";
    info_.map_frame = "map";
    info_.frames = 8;
    info_.camera.depth = {320, 240, 292, 292, 160, 120};
    info_.camera.color = {640, 480, 528, 528, 320, 240};
    info_.camera.depth_from_color.translation().x() = 0.022;
    for (size_t i = 0; i < info_.frames; ++i) frames_.push_back(rendered(i));
  }

  const RecordingInfo& info() const override { return info_; }
  size_t size() const override { return info_.frames; }
  TimeNs time_of(size_t i) const override { return static_cast<TimeNs>(i) * kSecond; }
  int64_t index_of(size_t i) const override { return static_cast<int64_t>(i); }

  RgbdFrame frame(size_t i) const override {
    RgbdFrame frame = frames_[i];
    if (!posed_)
      frame.map_from_camera.reset();
    else if (i % 2 == 1)
      frame.map_from_camera->translation() += drift_;
    return frame;
  }

  RecordingInfo info_;
  bool posed_ = true;
  Vector3d drift_ = Vector3d(0.012, 0.006, -0.006);

 private:
  RgbdFrame rendered(size_t i) const {
    RgbdFrame frame;
    frame.index = static_cast<int64_t>(i);
    frame.camera = info_.camera;
    const double step = static_cast<double>(i) / 7 - 0.5;
    Isometry3d pose = Isometry3d::Identity();
    const Vector3d from(1.6 + 0.1 * step, front_.side + 0.8 * step, 1.3), at(0, 0.3 * step, 0.55);
    const Vector3d forward = (at - from).normalized(), right = forward.cross(Vector3d::UnitZ()).normalized();
    pose.linear() << right, forward.cross(right), forward;
    pose.translation() = from;
    Random random = Random(11).fork(i);
    frame.depth = cv::Mat(info_.camera.depth.height, info_.camera.depth.width, CV_32F);
    for (int y = 0; y < frame.depth.rows; ++y)
      for (int x = 0; x < frame.depth.cols; ++x) {
        const double z = depth_at(pose, info_.camera.depth, x, y).first;
        frame.depth.at<float>(y, x) = static_cast<float>(z + random.normal(0.004));
      }
    frame.color = cv::Mat(info_.camera.color.height, info_.camera.color.width, CV_8UC3);
    const Isometry3d color_pose = pose * info_.camera.depth_from_color;
    for (int y = 0; y < frame.color.rows; ++y)
      for (int x = 0; x < frame.color.cols; ++x) {
        const double gain = i % 3 == 0 ? 0.9 : 1;  // exposure
        const cv::Vec3b color = depth_at(color_pose, info_.camera.color, x, y).second;
        for (int c = 0; c < 3; ++c)
          frame.color.at<cv::Vec3b>(y, x)[c] = cv::saturate_cast<uint8_t>(gain * color[c] + random.normal(2));
      }
    frame.map_from_camera = pose;
    return frame;
  }

  /// z-depth and colour of what a pixel shows.
  std::pair<double, cv::Vec3b> depth_at(const Isometry3d& pose, const PinholeCamera& camera, int x,
                                        int y) const {
    const Vector3d ray = pose.linear() * camera.unproject(x, y, 1), from = pose.translation();
    for (const PaintedFront::Bar& bar : front_.bars) {
      const double z = (bar.depth - from.x()) / ray.x();
      const Vector3d at = from + z * ray;
      if (z > 0 && at.y() > bar.u0 && at.y() < bar.u1 && at.z() > bar.v0 && at.z() < bar.v1)
        return {z, {215, 215, 215}};
    }
    for (const double plane : {front_.step, 0.0}) {
      const double z = (plane - from.x()) / ray.x();
      const Vector3d at = from + z * ray;
      if (plane == 0 || at.y() > 0) return {z, front_.color(at.y(), at.z())};
    }
    return {};
  }

  PaintedFront front_;
  std::vector<RgbdFrame> frames_;
};

inline FurnitureFace painted_face() {
  FurnitureFace face;
  face.u_min = -0.75;
  face.u_max = 0.75;
  face.v_min = 0.05;
  face.v_max = 0.95;
  face.area = 1.3;
  return face;
}

/// Two doors with a level handle each.
inline PaintedFront two_doors() {
  PaintedFront front;
  front.upright_seams = {0};
  front.bars = {{-0.39, -0.21, 0.775, 0.787, 0.03}, {0.21, 0.39, 0.775, 0.787, 0.03}};
  return front;
}

}  // namespace loci::mapping
