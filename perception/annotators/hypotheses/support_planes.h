#pragma once

#include <array>
#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "mapping/base/options.h"
#include "mapping/base/pose.h"
#include "mapping/sensor/camera.h"

namespace loci {

/// How horizontal supports are found and refined in one frame.
struct SupportOptions {
  double inlier_m = 0.02;
  double normal_deg = 25;
  double min_area_m2 = 0.04;
  double max_below_camera_m = 1.25;
  double bridge_m = 0.15;

  void declare(OptionTable& table);
};

/// A plane that things stand on, as one frame shows it. All in the camera frame, metres.
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

  /// Position in the plane's frame with z = height over the (bent) surface.
  Vector3d in_plane(const Vector3d& point) const;
  /// Signed distance of a plane position to the outline, metres, positive inside.
  double inside(const Vector2d& position) const;
};

/// Standard deviation to reckon with for a depth of `z` metres: half a quantum of a Kinect's disparity.
double depth_noise(double z);

/// Refines a plane on the pixels of `mask` (CV_8U, empty = all): inliers in distance and in normal, weighted
/// least squares, bend, outline. Empty when what is left is smaller than min_area_m2.
std::optional<SupportPlane> refine_support(const cv::Mat& points, const cv::Mat& normals, const cv::Mat& mask,
                                           const Vector3d& normal, double offset,
                                           const SupportOptions& options);

/// All horizontal supports in view, nearest to the camera's height last, when `up` (unit, camera frame) is
/// known; otherwise the one plane that dominates the picture and looks upwards in it.
std::vector<SupportPlane> find_supports(const cv::Mat& points, const cv::Mat& normals,
                                        const std::optional<Vector3d>& up, const SupportOptions& options);

}  // namespace loci
