#include "mapping/tracking/keyframe.h"

#include <cmath>
#include <limits>

namespace loci::mapping::tracking {

Keyframe::Keyframe(size_t number, FrameImages images, Features features)
    : number_(number),
      images_(std::move(images)),
      weights_(images_.levels.front().inverse_depth.size(), CV_32F, cv::Scalar(1)),
      features_(std::move(features)),
      points_(images_.levels.size()) {
  rebuild_points();
}

void Keyframe::rebuild_points() {
  const ImageLevel& finest = images_.levels.front();
  const Isometry3d color_from_depth = images_.depth_from_color.inverse();
  for (size_t level = 0; level < points_.size(); ++level) {
    points_[level].clear();
    const PinholeCamera& color = images_.levels[level].color_camera;
    const cv::Mat& intensity = images_.levels[level].intensity;
    const int stride = kAlignment.stride[level] << level;
    for (int v = stride / 2; v < finest.inverse_depth.rows; v += stride) {
      for (int u = stride / 2; u < finest.inverse_depth.cols; u += stride) {
        const cv::Vec3f& normal = finest.normals.at<cv::Vec3f>(v, u);
        const float inverse = finest.inverse_depth.at<float>(v, u);
        if (inverse <= 0 || normal[2] == 0) continue;
        const Vector3d position = finest.depth_camera.unproject(u, v, 1 / static_cast<double>(inverse));
        ModelPoint point{position.cast<float>(),
                         {normal[0], normal[1], normal[2]},
                         std::numeric_limits<float>::quiet_NaN()};
        const Vector3d from_color = color_from_depth * position;
        if (!intensity.empty() && from_color.z() > 0.1) {
          cv::Vec3f sample;
          if (interpolated(intensity, color.project(from_color).cast<float>(), sample))
            point.intensity = sample[0];
        }
        points_[level].push_back(point);
      }
    }
  }
}

void Keyframe::fuse(const FrameImages& frame, const Isometry3d& frame_from_keyframe) {
  ImageLevel& own = images_.levels.front();
  const ImageLevel& other = frame.levels.front();
  const FloatMotion transform(frame_from_keyframe);
  const FloatMotion back(frame_from_keyframe.inverse());
  const auto fx = static_cast<float>(other.depth_camera.fx), fy = static_cast<float>(other.depth_camera.fy),
             cx = static_cast<float>(other.depth_camera.cx), cy = static_cast<float>(other.depth_camera.cy);
  for (int v = 0; v < own.inverse_depth.rows; ++v) {
    auto* inverse = own.inverse_depth.ptr<float>(v);
    const auto* normals = own.normals.ptr<cv::Vec3f>(v);
    auto* weights = weights_.ptr<float>(v);
    for (int u = 0; u < own.inverse_depth.cols; ++u) {
      if (inverse[u] <= 0 || normals[u][2] == 0) continue;
      const Eigen::Vector3f ray(static_cast<float>((u - own.depth_camera.cx) / own.depth_camera.fx),
                                static_cast<float>((v - own.depth_camera.cy) / own.depth_camera.fy), 1);
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
      const float weight = weights[u];
      inverse[u] = (inverse[u] * weight + update) / (weight + 1);
      weights[u] = std::min(weight + 1, kKeyframes.max_weight);
    }
  }
  ++fused_;
  if (fused_ != 2 && fused_ != 5 && fused_ % 10 != 0) return;
  own.normals = normals_of(own.inverse_depth, own.depth_camera, kImages.normal_step);
  rebuild_points();
}

}  // namespace loci::mapping::tracking
