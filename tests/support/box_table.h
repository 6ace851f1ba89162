#pragma once

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <opencv2/core.hpp>
#include <optional>

#include "mapping/base/math/math.h"
#include "mapping/recording/recording.h"

namespace loci::test {

/// A table with boxes of 8 cm every 30 cm along x (at 0, 0.3, …; y = 0.8 m), and a wall, as a camera sees
/// them.
struct BoxTable {
  Isometry3d map_from_camera = Isometry3d::Identity();
  double table_height = 0.7;  ///< metres; below 0 = no table
  double wall_m = 2;          ///< y of the wall
};

/// Camera 1.2 m above the floor that looks along y, down by `pitch`; rolled about its axis.
inline Isometry3d table_camera(double x, double pitch_deg = 35, double roll_deg = 0) {
  Isometry3d pose = Isometry3d::Identity();
  pose.linear() = (Eigen::AngleAxisd(-(90 + pitch_deg) * kDegree, Vector3d::UnitX()) *
                   Eigen::AngleAxisd(roll_deg * kDegree, Vector3d::UnitZ()))
                      .toRotationMatrix();
  pose.translation() = Vector3d(x, 0, 1.2);
  return pose;
}

inline mapping::RgbdCamera table_cameras() {
  mapping::RgbdCamera camera;
  camera.depth = {160, 120, 146, 146, 80, 60};
  camera.color = camera.depth;
  return camera;
}

/// Distance along a ray of z-depth 1: to the front or top of a box, the table, or the wall.
inline double range_to(const Vector3d& origin, const Vector3d& ray, const BoxTable& view) {
  double range = (view.wall_m - origin.y()) / std::max(1e-6, ray.y());
  if (view.table_height < 0) return range;
  const auto reach = [&](double there, bool on_box) {
    if (!(there > 0) || there >= range) return;
    const Vector3d point = origin + there * ray;
    const Vector3d in_box(std::remainder(point.x(), 0.3), point.y() - 0.8, point.z() - view.table_height);
    const bool inside = std::abs(in_box.x()) < 0.0401 && std::abs(in_box.y()) < 0.0401 &&
                        in_box.z() > -1e-4 && in_box.z() < 0.0801;
    if (inside || !on_box) range = there;
  };
  if (ray.z() < 0) reach((view.table_height - origin.z()) / ray.z(), false);
  if (ray.z() < 0) reach((view.table_height + 0.08 - origin.z()) / ray.z(), true);
  reach((0.76 - origin.y()) / ray.y(), true);
  for (const double side : {-0.04, 0.04})
    for (int box = -3; box <= 3; ++box) reach((0.3 * box + side - origin.x()) / ray.x(), true);
  return range;
}

inline mapping::RgbdFrame table_frame(const BoxTable& view, const mapping::RgbdCamera& camera,
                                      int64_t index) {
  mapping::RgbdFrame frame;
  frame.index = index;
  frame.time_ns = 1'700'000'000 * kSecond + index * kSecond;
  frame.camera = camera;
  frame.depth = cv::Mat(camera.depth.height, camera.depth.width, CV_32F);
  frame.color = cv::Mat(camera.color.height, camera.color.width, CV_8UC3, cv::Scalar(40, 90, 160));
  for (int v = 0; v < frame.depth.rows; ++v)
    for (int u = 0; u < frame.depth.cols; ++u)
      frame.depth.at<float>(v, u) =
          static_cast<float>(range_to(view.map_from_camera.translation(),
                                      view.map_from_camera.linear() * camera.depth.unproject(u, v, 1), view));
  return frame;
}

/// Writes a recording of views; `pose_of` is what it says about the poses.
inline void record_table(const std::filesystem::path& folder, int64_t frames,
                         const std::function<BoxTable(int64_t)>& view_of,
                         const std::function<std::optional<Isometry3d>(int64_t)>& pose_of,
                         const std::string& map_frame = "world") {
  mapping::RecordingWriter writer(folder, table_cameras(), map_frame);
  for (int64_t i = 0; i < frames; ++i) {
    mapping::RgbdFrame frame = table_frame(view_of(i), table_cameras(), i);
    frame.map_from_camera = pose_of(i);
    writer.add(frame);
  }
  writer.finish();
}

}  // namespace loci::test
