#include "perception/annotators/hypotheses/support_pixels.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "perception/annotators/scene_data.h"

namespace loci::perception {

std::pair<Vector3d, double> plane_in_camera(const types::PlanarSupport& support, const Isometry3d& pose) {
  const auto normal = types::from<Vector3d>(support.normal.get());
  return {pose.linear().transpose() * normal, support.offset.get() - normal.dot(pose.translation())};
}

cv::Mat pixels_over(const types::PlanarSupport& support, const Isometry3d& camera_from_map,
                    const mapping::PinholeCamera& camera) {
  std::vector<cv::Point> corners;
  for (const Vector3d& corner : types::points_from_values(support.outline.get())) {
    const Vector3d p = camera_from_map * corner;
    if (p.z() < 0.1) continue;  // Beside or behind the camera.
    const Vector2d at = camera.project(p);
    corners.emplace_back(static_cast<int>(std::lround(std::clamp(at.x(), -1e4, 1e4))),
                         static_cast<int>(std::lround(std::clamp(at.y(), -1e4, 1e4))));
  }
  cv::Mat inside(camera.height, camera.width, CV_8U, cv::Scalar(0));
  if (corners.size() < 3) return inside;
  std::vector<cv::Point> hull;
  cv::convexHull(corners, hull);
  cv::fillConvexPoly(inside, hull, cv::Scalar(255));
  return inside;
}

void leave_out_what_the_map_hides(const cv::Mat& map_depth, const Vector3d& normal, double offset,
                                  const mapping::PinholeCamera& camera, cv::Mat& inside) {
  constexpr double kOver_m = 0.01;  // a surface is not over itself
  for (int v = 0; v < inside.rows; ++v) {
    const auto* depth = map_depth.ptr<float>(v);
    auto* pixel = inside.ptr<unsigned char>(v);
    for (int u = 0; u < inside.cols; ++u)
      if (pixel[u] != 0 &&
          normal.dot(camera.unproject(u, v, static_cast<double>(depth[u]))) - offset > kOver_m)
        pixel[u] = 0;
  }
}

cv::Mat pixels_of_clusters(const types::SceneCas& scene, const cv::Size& size, int margin) {
  cv::Mat taken = cv::Mat::zeros(size, CV_8U);
  for (const types::Cluster& cluster : scene.clusters())
    for (const int32_t index : cluster_indices(cluster)) taken.ptr<unsigned char>()[index] = 255;
  if (margin > 0) cv::dilate(taken, taken, cv::Mat::ones(2 * margin + 1, 2 * margin + 1, CV_8U));
  return taken;
}

}  // namespace loci::perception
