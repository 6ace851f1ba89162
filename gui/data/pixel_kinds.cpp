#include "gui/data/pixel_kinds.h"

#include <cmath>
#include <opencv2/imgproc.hpp>

namespace loci::gui {

cv::Mat kinds_in_color(const SceneContent& content) {
  const mapping::RgbdCamera& camera = content.camera;
  if (content.kinds.empty() || content.kinds.size() != content.depth.size() || camera.color.width <= 0)
    return {};
  const Isometry3d color_from_depth = camera.depth_from_color.inverse();
  const double depth_x = static_cast<double>(camera.depth.width) / content.depth.cols;
  const double depth_y = static_cast<double>(camera.depth.height) / content.depth.rows;
  const double color_x = static_cast<double>(content.depth.cols) / camera.color.width;
  const double color_y = static_cast<double>(content.depth.rows) / camera.color.height;
  const cv::Rect all(0, 0, content.kinds.cols, content.kinds.rows);
  cv::Mat seen(content.kinds.size(), CV_8U, cv::Scalar(0));
  cv::Mat nearest(content.kinds.size(), CV_64F, cv::Scalar(1e9));
  for (int v = 0; v < content.depth.rows; ++v)
    for (int u = 0; u < content.depth.cols; ++u) {
      const float z = content.depth.at<float>(v, u);
      if (!std::isfinite(z) || z <= 0) continue;
      const Vector3d point =
          color_from_depth * camera.depth.unproject((u + 0.5) * depth_x - 0.5, (v + 0.5) * depth_y - 0.5,
                                                    static_cast<double>(z));
      if (point.z() <= 0) continue;
      const Vector2d pixel = camera.color.project(point);
      const cv::Point at(static_cast<int>(std::floor((pixel.x() + 0.5) * color_x)),
                         static_cast<int>(std::floor((pixel.y() + 0.5) * color_y)));
      if (!all.contains(at) || nearest.at<double>(at) <= point.z()) continue;
      nearest.at<double>(at) = point.z();
      seen.at<uint8_t>(at) = content.kinds.at<uint8_t>(v, u);
    }
  // Between pixels that have spread apart: what is beside them.
  cv::Mat filled;
  cv::dilate(seen, filled, {});
  filled.copyTo(seen, seen == 0);
  return seen;
}

}  // namespace loci::gui
