#include "perception/annotators/hypotheses/color_region.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace loci::perception {

ColorRegion color_region(const cv::Mat& points, const std::vector<int>& pixels,
                         const mapping::RgbdCamera& camera, const cv::Size& size) {
  const Isometry3d color_from_depth = camera.depth_from_color.inverse();
  // A depth pixel covers this many colour pixels, more where the colour image is larger.
  const double scale = camera.color.fx / camera.depth.fx * size.width / std::max(1, camera.color.width);
  const int spread = std::max(0, static_cast<int>(std::ceil((scale - 1.0) / 2)));
  std::vector<cv::Point> hits;
  hits.reserve(pixels.size());
  cv::Rect box;
  const cv::Rect image({0, 0}, size);
  for (const int pixel : pixels) {
    const cv::Vec3f& p = points.ptr<cv::Vec3f>()[pixel];
    const Vector3d in_color =
        color_from_depth *
        Vector3d(static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2]));
    if (!(in_color.z() > 0)) continue;
    const Vector2d at = camera.color.project(in_color);
    const cv::Point hit(static_cast<int>(std::lround(at.x())), static_cast<int>(std::lround(at.y())));
    if (!image.contains(hit)) continue;
    hits.push_back(hit);
    const cv::Rect one(hit, cv::Size(1, 1));
    box = box.empty() ? one : (box | one);
  }
  if (box.empty()) return {};
  box = cv::Rect(box.x - spread, box.y - spread, box.width + 2 * spread, box.height + 2 * spread) & image;
  cv::Mat mask = cv::Mat::zeros(box.size(), CV_8U);
  for (const cv::Point& hit : hits) mask.at<unsigned char>(hit - box.tl()) = 255;
  if (spread > 0) cv::dilate(mask, mask, cv::Mat::ones(2 * spread + 1, 2 * spread + 1, CV_8U));
  cv::morphologyEx(mask, mask, cv::MORPH_CLOSE, cv::Mat::ones(3, 3, CV_8U));
  return {box, mask};
}

}  // namespace loci::perception
