#include "perception/annotators/hypotheses/plane_registration.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace loci::perception {
namespace {

Eigen::Matrix3d intrinsics(const mapping::PinholeCamera& camera) {
  Eigen::Matrix3d k;
  k << camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1;
  return k;
}

}  // namespace

PlaneRegistration::PlaneRegistration(const mapping::RgbdCamera& camera, const Vector3d& normal, double offset)
    : columns_(camera.color.height, camera.color.width, CV_32F),
      rows_(camera.color.height, camera.color.width, CV_32F) {
  constexpr float kBeside = -10;
  const Vector3d& eye = camera.depth_from_color.translation();
  // A ray r from `eye` meets the plane in the direction of (normal · r) eye + up r.
  const Eigen::Matrix3d ray = camera.depth_from_color.linear() * intrinsics(camera.color).inverse();
  const Eigen::RowVector3d slope = normal.transpose() * ray;
  const Eigen::Matrix3d met = eye * slope + (offset - normal.dot(eye)) * ray;
  const Eigen::Matrix3d pixel = intrinsics(camera.depth) * met;
  for (int v = 0; v < columns_.rows; ++v) {
    const Vector3d start = pixel.col(1) * v + pixel.col(2);
    const double slope_start = slope[1] * v + slope[2];
    auto* column = columns_.ptr<float>(v);
    auto* row = rows_.ptr<float>(v);
    for (int u = 0; u < columns_.cols; ++u) {
      const double w = start.z() + pixel(2, 0) * u;
      const bool before = w * (slope_start + slope[0] * u) > 0;
      const double inverse = 1 / w;
      column[u] = before ? static_cast<float>((start.x() + pixel(0, 0) * u) * inverse) : kBeside;
      row[u] = before ? static_cast<float>((start.y() + pixel(1, 0) * u) * inverse) : kBeside;
    }
  }
}

cv::Mat PlaneRegistration::seen_by_color(const cv::Mat& image, double outside) const {
  cv::Mat result;
  cv::remap(image, result, columns_, rows_, cv::INTER_NEAREST, cv::BORDER_CONSTANT, cv::Scalar(outside));
  return result;
}

cv::Rect box_in_color(const cv::Rect& box, const mapping::RgbdCamera& camera, const Vector3d& normal,
                      double offset) {
  constexpr int kMore = 20;  // What is higher than the plane is seen beside it.
  const cv::Rect all(0, 0, camera.color.width, camera.color.height);
  const Isometry3d color_from_depth = camera.depth_from_color.inverse();
  double left = 1e9;
  double right = -1e9;
  double top = 1e9;
  double bottom = -1e9;
  for (const int u : {box.x, box.x + box.width})
    for (const int v : {box.y, box.y + box.height}) {
      const Vector3d ray = camera.depth.unproject(u, v, 1);
      const Vector3d p = color_from_depth * Vector3d(offset / normal.dot(ray) * ray);
      if (offset * normal.dot(ray) <= 0 || p.z() < 0.1) return all;
      const Vector2d at = camera.color.project(p);
      if (at.cwiseAbs().maxCoeff() > 1e5) return all;
      left = std::min(left, at.x());
      right = std::max(right, at.x());
      top = std::min(top, at.y());
      bottom = std::max(bottom, at.y());
    }
  const cv::Point low(static_cast<int>(left) - kMore, static_cast<int>(top) - kMore);
  const cv::Point high(static_cast<int>(right) + kMore, static_cast<int>(bottom) + kMore);
  return cv::Rect(low, high) & all;
}

mapping::PinholeCamera cropped(const mapping::PinholeCamera& camera, const cv::Rect& box) {
  return {box.width, box.height, camera.fx, camera.fy, camera.cx - box.x, camera.cy - box.y};
}

}  // namespace loci::perception
