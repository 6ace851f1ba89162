#include "gui/data/frame_cloud.h"

#include <algorithm>
#include <cmath>

namespace loci::gui {

std::array<uint8_t, 3> color_at(const SceneContent& content, const Vector3d& in_camera) {
  constexpr std::array<uint8_t, 3> kGrey = {150, 150, 150};
  if (content.color.empty()) return kGrey;
  const Vector3d in_color = content.camera.depth_from_color.inverse() * in_camera;
  if (in_color.z() <= 0) return kGrey;
  const Vector2d pixel = content.camera.color.project(in_color);
  if (!content.camera.color.contains(pixel)) return kGrey;
  // The stored image may be smaller than the camera's.
  const int x = static_cast<int>((pixel.x() + 0.5) * content.color.cols / content.camera.color.width);
  const int y = static_cast<int>((pixel.y() + 0.5) * content.color.rows / content.camera.color.height);
  const auto& bgr = content.color.at<cv::Vec3b>(std::clamp(y, 0, content.color.rows - 1),
                                                std::clamp(x, 0, content.color.cols - 1));
  return {bgr[2], bgr[1], bgr[0]};
}

ColoredCloud frame_cloud(const SceneContent& content, size_t limit) {
  ColoredCloud cloud;
  if (content.depth.empty() || !content.map_from_camera || limit == 0) return cloud;
  const auto pixels = static_cast<double>(content.depth.total());
  const int step = std::max(1, static_cast<int>(std::ceil(std::sqrt(pixels / static_cast<double>(limit)))));
  const mapping::PinholeCamera& camera = content.camera.depth;
  const double scale_x = static_cast<double>(camera.width) / content.depth.cols;
  const double scale_y = static_cast<double>(camera.height) / content.depth.rows;
  for (int v = step / 2; v < content.depth.rows; v += step)
    for (int u = step / 2; u < content.depth.cols; u += step) {
      const float z = content.depth.at<float>(v, u);
      if (!std::isfinite(z) || z <= 0) continue;
      const Vector3d point =
          camera.unproject((u + 0.5) * scale_x - 0.5, (v + 0.5) * scale_y - 0.5, static_cast<double>(z));
      cloud.points.push_back((*content.map_from_camera * point).cast<float>());
      cloud.colors.push_back(color_at(content, point));
    }
  return cloud;
}

}  // namespace loci::gui
