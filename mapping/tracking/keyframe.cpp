#include "mapping/tracking/keyframe.h"

#include <cmath>
#include <limits>
#include <opencv2/core.hpp>

namespace loci::mapping::tracking {

Keyframe::Keyframe(size_t number, const FrameImages& images, Features features)
    : number_(number),
      camera_(images.levels.front().depth_camera),
      inverse_depth_(images.levels.front().inverse_depth),
      normals_(images.levels.front().normals),
      weights_(inverse_depth_.size(), CV_8U, cv::Scalar(1)),
      color_from_depth_(images.depth_from_color.inverse()),
      features_(std::move(features)),
      points_(images.levels.size()) {
  for (const ImageLevel& level : images.levels) {
    intensities_.push_back({level.color_camera, {}});
    if (!level.intensity.empty()) cv::extractChannel(level.intensity, intensities_.back().logarithm, 0);
  }
  rebuild_points();
}

void Keyframe::rebuild_points() {
  for (size_t level = 0; level < points_.size(); ++level) {
    const auto& [color, logarithm] = intensities_[level];
    const int stride = kAlignment.stride[level] << level;
    points_[level].clear();
    points_[level].reserve(inverse_depth_.total() / static_cast<size_t>(stride * stride));
    for (int v = stride / 2; v < inverse_depth_.rows; v += stride) {
      for (int u = stride / 2; u < inverse_depth_.cols; u += stride) {
        const cv::Vec3f& normal = normals_.at<cv::Vec3f>(v, u);
        const float inverse = inverse_depth_.at<float>(v, u);
        if (inverse <= 0 || normal[2] == 0) continue;
        const Vector3d position = camera_.unproject(u, v, 1 / static_cast<double>(inverse));
        ModelPoint point{position.cast<float>(),
                         {normal[0], normal[1], normal[2]},
                         std::numeric_limits<float>::quiet_NaN()};
        const Vector3d from_color = color_from_depth_ * position;
        if (!logarithm.empty() && from_color.z() > 0.1)
          interpolated(logarithm, color.project(from_color).cast<float>(), point.intensity);
        if (is_saturated(point.intensity)) point.intensity = std::numeric_limits<float>::quiet_NaN();
        points_[level].push_back(point);
      }
    }
  }
}

void Keyframe::fuse(const FrameImages& frame, const Isometry3d& frame_from_keyframe) {
  const ImageLevel& other = frame.levels.front();
  const FloatMotion transform(frame_from_keyframe);
  const FloatMotion back(frame_from_keyframe.inverse());
  const auto fx = static_cast<float>(other.depth_camera.fx), fy = static_cast<float>(other.depth_camera.fy),
             cx = static_cast<float>(other.depth_camera.cx), cy = static_cast<float>(other.depth_camera.cy);
  for (int v = 0; v < inverse_depth_.rows; ++v) {
    auto* inverse = inverse_depth_.ptr<float>(v);
    const auto* normals = normals_.ptr<cv::Vec3f>(v);
    auto* weights = weights_.ptr<uint8_t>(v);
    for (int u = 0; u < inverse_depth_.cols; ++u) {
      if (inverse[u] <= 0 || normals[u][2] == 0) continue;
      const Eigen::Vector3f ray(static_cast<float>((u - camera_.cx) / camera_.fx),
                                static_cast<float>((v - camera_.cy) / camera_.fy), 1);
      const Eigen::Vector3f seen = transform * Eigen::Vector3f(ray / inverse[u]);
      if (seen.z() < 0.1F) continue;
      const int x = static_cast<int>(std::lround(fx * seen.x() / seen.z() + cx)),
                y = static_cast<int>(std::lround(fy * seen.y() / seen.z() + cy));
      if (x < 0 || y < 0 || x >= other.inverse_depth.cols || y >= other.inverse_depth.rows) continue;
      const float measured = other.inverse_depth.at<float>(y, x);
      if (measured <= 0) continue;
      const float z = 1 / measured;
      const Eigen::Vector3f point = back * Eigen::Vector3f((static_cast<float>(x) - cx) / fx * z,
                                                           (static_cast<float>(y) - cy) / fy * z, z);
      const Eigen::Vector3f normal(normals[u][0], normals[u][1], normals[u][2]);
      const float along = normal.dot(point);  // The ray meets the tangent plane through the measured point.
      if (!(along < 0)) continue;
      const float update = normal.dot(ray) / along;
      if (std::abs(update - inverse[u]) > 0.5F * (kImages.jump + kImages.relative_jump * inverse[u]))
        continue;
      const auto weight = static_cast<float>(weights[u]);
      inverse[u] = (inverse[u] * weight + update) / (weight + 1);
      if (weights[u] < kKeyframes.max_weight) ++weights[u];
    }
  }
  ++fused_;
  if (fused_ != 2 && fused_ != 5 && fused_ % 10 != 0) return;
  normals_ = normals_of(inverse_depth_, camera_, kImages.normal_step);
  rebuild_points();
}

}  // namespace loci::mapping::tracking
