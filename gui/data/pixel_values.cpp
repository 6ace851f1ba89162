#include "gui/data/pixel_values.h"

#include <cmath>

namespace loci::gui {
namespace {

constexpr int kSteps = 6;  // of the search for a colour pixel's depth
constexpr double kFirstGuess = 1.5;

/// Pixel of an image that may be stored smaller than the camera's; unset outside.
std::optional<cv::Point> stored_pixel(const cv::Mat& image, const mapping::PinholeCamera& camera,
                                      const Vector2d& pixel) {
  if (image.empty() || camera.width <= 0 || camera.height <= 0) return std::nullopt;
  const cv::Point at(static_cast<int>(std::floor((pixel.x() + 0.5) * image.cols / camera.width)),
                     static_cast<int>(std::floor((pixel.y() + 0.5) * image.rows / camera.height)));
  return cv::Rect(0, 0, image.cols, image.rows).contains(at) ? std::optional(at) : std::nullopt;
}

std::optional<double> depth_at(const SceneContent& content, const Vector2d& pixel) {
  const auto at = stored_pixel(content.depth, content.camera.depth, pixel);
  if (!at) return std::nullopt;
  const float z = content.depth.at<float>(*at);
  return std::isfinite(z) && z > 0 ? std::optional(static_cast<double>(z)) : std::nullopt;
}

std::optional<std::array<uint8_t, 3>> color_at(const SceneContent& content, const Vector2d& pixel) {
  const auto at = stored_pixel(content.color, content.camera.color, pixel);
  if (!at) return std::nullopt;
  const auto& bgr = content.color.at<cv::Vec3b>(*at);
  return std::array<uint8_t, 3>{bgr[2], bgr[1], bgr[0]};
}

}  // namespace

PixelValues values_at_depth(const SceneContent& content, const Vector2d& pixel) {
  PixelValues values;
  values.depth = depth_at(content, pixel);
  if (!values.depth) return values;
  const Vector3d point = content.camera.depth.unproject(pixel.x(), pixel.y(), *values.depth);
  const Vector3d in_color = content.camera.depth_from_color.inverse() * point;
  if (in_color.z() > 0) values.color = color_at(content, content.camera.color.project(in_color));
  if (content.map_from_camera) values.position = *content.map_from_camera * point;
  return values;
}

PixelValues values_at_color(const SceneContent& content, const Vector2d& pixel) {
  PixelValues values;
  values.color = color_at(content, pixel);
  double z = kFirstGuess;  // along the colour camera's axis
  for (int i = 0; i < kSteps; ++i) {
    const Vector3d guess =
        content.camera.depth_from_color * content.camera.color.unproject(pixel.x(), pixel.y(), z);
    if (guess.z() <= 0) return values;
    const Vector2d there = content.camera.depth.project(guess);
    values.depth = depth_at(content, there);
    if (!values.depth) return values;
    const Vector3d point = content.camera.depth.unproject(there.x(), there.y(), *values.depth);
    if (content.map_from_camera) values.position = *content.map_from_camera * point;
    z = (content.camera.depth_from_color.inverse() * point).z();
  }
  return values;
}

}  // namespace loci::gui
