#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/core.hpp>
#include <optional>
#include <utility>
#include <vector>

#include "mapping/base/math/pose.h"
#include "mapping/base/options.h"
#include "mapping/sensor/camera.h"
#include "mapping/sensor/depth_noise.h"
#include "perception/types/scene_cas.h"

namespace loci::perception {

/// How horizontal supports are found and refined in one frame.
struct SupportOptions {
  double inlier_m = 0.02;
  double normal_deg = 25;
  double min_area_m2 = 0.04;
  double max_below_camera_m = 1.25;
  double bridge_m = 0.15;

  void declare(OptionTable& table);
};

/// A polygon that does not cross itself, corners in order, made ready to be asked about many positions.
class PolygonOutline {
 public:
  PolygonOutline() = default;
  explicit PolygonOutline(const std::vector<Vector2d>& corners);

  /// Signed distance of a position to the nearest edge, positive inside; -1e9 without an outline.
  double inside(const Vector2d& position) const {
    if (edges_.empty()) return -1e9;
    double nearest = 1e18;
    bool within = false;
    for (const Edge& edge : edges_) {
      const double x = position.x() - edge.x, y = position.y() - edge.y;
      const double along = std::clamp(x * edge.along_x + y * edge.along_y, 0.0, edge.length);
      const double dx = x - along * edge.along_x, dy = y - along * edge.along_y;
      nearest = std::min(nearest, dx * dx + dy * dy);
      if ((edge.y > position.y()) != (edge.end_y > position.y()) && x < y * edge.along_x / edge.along_y)
        within = !within;
    }
    return within ? std::sqrt(nearest) : -std::sqrt(nearest);
  }

 private:
  struct Edge {
    double x, y, along_x, along_y, length, end_y;  ///< from (x, y) along a unit vector
  };
  std::vector<Edge> edges_;
};

/// A plane that objects stand on, as one frame shows it. All in the camera frame, metres.
struct SupportPlane {
  Vector3d normal = -Vector3d::UnitY();                   ///< unit, away from the support (up)
  double offset = 0;                                      ///< normal · p = offset for a point p of the plane
  Isometry3d camera_from_plane = Isometry3d::Identity();  ///< z = normal, origin at the inliers' mean
  std::vector<Vector2d> outline;  ///< convex hull of the inliers in the plane's x, y; counter-clockwise
  /// The seen surface is not quite a plane (distortion of the sensor, two tables side by side): its height
  /// over the plane is the polynomial (1, x, y, x², xy, y²) · bend.
  std::array<double, 6> bend = {};
  double area = 0;         ///< seen, m²
  double deviation = 0;    ///< root mean square of the inliers' heights after bending, metres
  int inliers = 0;         ///< pixels
  double uncertainty = 0;  ///< of the height, beyond the noise of the depth, metres
  int region = 0;  ///< value of the region label image that it was refined in; 0 = found without a map
  bool in_drawer = false;  ///< the bottom of a drawer of the map

  /// Position in the plane's frame with z = height over the (bent) surface.
  Vector3d in_plane(const Vector3d& point) const {
    Vector3d p = camera_from_plane.linear().transpose() * (point - camera_from_plane.translation());
    p.z() -= std::clamp(bend[0] + bend[1] * p.x() + bend[2] * p.y() + bend[3] * p.x() * p.x() +
                            bend[4] * p.x() * p.y() + bend[5] * p.y() * p.y(),
                        -0.02, 0.02);
    return p;
  }
};

using mapping::depth_noise;

/// Error of the height over a support that comes from that of a point's depth (camera frame). Where one looks
/// along the support it is smaller than that of the depth; where one looks down by 45° or more, the
/// distortion of the sensor and the bend of the surface take the difference.
inline double height_noise(const SupportPlane& support, const Vector3d& point) {
  constexpr double kSteep = 0.7;
  return depth_noise(point.z()) * std::min(1.0, std::abs(support.normal.dot(point)) / point.z() / kSteep);
}

/// Refines a plane on some pixels (row · width + column): inliers in distance and in normal, weighted least
/// squares, bend, outline. Empty when what is left is smaller than min_area_m2.
std::optional<SupportPlane> refine_support(const cv::Mat& points, const cv::Mat& normals,
                                           const std::vector<int>& pixels, const Vector3d& normal,
                                           double offset, const SupportOptions& options);

/// All horizontal supports in view, nearest to the camera's height last, when `up` (unit, camera frame) is
/// known; otherwise the one plane that dominates the image and looks upwards in it.
std::vector<SupportPlane> find_supports(const cv::Mat& points, const cv::Mat& normals,
                                        const mapping::PinholeCamera& camera,
                                        const std::optional<Vector3d>& up, const SupportOptions& options);

/// Normal n (unit, up) and offset of a support's plane in the camera's frame, n · p = offset, metres. `pose`
/// = map_from_camera.
std::pair<Vector3d, double> plane_in_camera(const types::PlanarSupport& support, const Isometry3d& pose);

/// Pixels of the depth image within the outline of a support, CV_8U, 255 = inside.
cv::Mat pixels_over(const types::PlanarSupport& support, const Isometry3d& camera_from_map,
                    const mapping::PinholeCamera& camera);

/// Takes out of `inside` (CV_8U) the pixels where the map shows something else than the bare support, and
/// what is within 1 cm of them: a front, a shelf or the side of a drawer hides it there, a sink or a hob is
/// let into it. `normal` and `offset` as in the camera's frame, metres; `map_depth`: CV_32F, what the map
/// alone would measure, NaN = nothing; `bare`: CV_8U, 0 = objects do not stand on that.
void leave_out_what_the_map_shows(const cv::Mat& map_depth, const cv::Mat& bare, const Vector3d& normal,
                                  double offset, const mapping::PinholeCamera& camera, cv::Mat& inside);

/// The clusters' pixels and those within `margin` of them, which show a bit of both; CV_8U, 255.
cv::Mat pixels_of_clusters(const types::SceneCas& scene, const cv::Size& size, int margin);

}  // namespace loci::perception
