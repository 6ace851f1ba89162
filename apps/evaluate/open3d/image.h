#pragma once

#include <open3d/camera/PinholeCameraIntrinsic.h>
#include <open3d/geometry/RGBDImage.h>

#include <cstring>
#include <memory>
#include <opencv2/imgproc.hpp>

#include "mapping/sensor/frame.h"

namespace loci::apps::open3d_peer {

inline open3d::geometry::Image image_of(const cv::Mat& mat) {
  open3d::geometry::Image image;
  image.Prepare(mat.cols, mat.rows, mat.channels(), static_cast<int>(mat.elemSize1()));
  for (int v = 0; v < mat.rows; ++v)
    std::memcpy(image.data_.data() + static_cast<size_t>(v) * static_cast<size_t>(image.BytesPerLine()),
                mat.ptr(v), static_cast<size_t>(image.BytesPerLine()));
  return image;
}

/// A frame as Open3D takes it, with depth up to `range_max_m`; colour as intensity for odometry.
inline std::shared_ptr<open3d::geometry::RGBDImage> rgbd_of(const mapping::RgbdFrame& frame,
                                                            double range_max_m, bool as_intensity) {
  cv::Mat rgb, depth = frame.depth.clone();
  cv::cvtColor(color_in_depth(frame), rgb, cv::COLOR_BGR2RGB);
  cv::patchNaNs(depth, 0);
  return open3d::geometry::RGBDImage::CreateFromColorAndDepth(image_of(rgb), image_of(depth), 1.0,
                                                              range_max_m, as_intensity);
}

inline open3d::camera::PinholeCameraIntrinsic intrinsic_of(const mapping::PinholeCamera& camera) {
  return {camera.width, camera.height, camera.fx, camera.fy, camera.cx, camera.cy};
}

}  // namespace loci::apps::open3d_peer
