#include "mapping/sensor/frame.h"

#include <cmath>

namespace loci::mapping {

cv::Mat color_in_depth(const RgbdFrame& frame) {
  cv::Mat registered(frame.depth.rows, frame.depth.cols, CV_8UC3, cv::Scalar(0, 0, 0));
  if (frame.color.empty()) return registered;
  const Isometry3d color_from_depth = frame.camera.depth_from_color.inverse();
  for (int v = 0; v < frame.depth.rows; ++v) {
    for (int u = 0; u < frame.depth.cols; ++u) {
      const float z = frame.depth.at<float>(v, u);
      if (std::isnan(z)) continue;
      const Vector3d point = color_from_depth * frame.camera.depth.unproject(u, v, static_cast<double>(z));
      if (point.z() <= 0) continue;
      const Vector2d pixel = frame.camera.color.project(point);
      if (!frame.camera.color.contains(pixel)) continue;
      registered.at<cv::Vec3b>(v, u) = frame.color.at<cv::Vec3b>(static_cast<int>(std::lround(pixel.y())),
                                                                 static_cast<int>(std::lround(pixel.x())));
    }
  }
  return registered;
}

}  // namespace loci::mapping
