#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "mapping/base/math/pose.h"
#include "mapping/sensor/camera.h"
#include "perception/types/geometry.h"
#include "perception/types/scene_cas.h"

namespace loci::perception {

/// Views that this module adds to those of SceneCas.
inline constexpr std::string_view kRegionsView = "regions";  ///< CV_16U: number of the region, 0 = none
inline constexpr std::string_view kMapDepthView = types::SceneCas::kMapDepth;
/// CV_8U: 255 = the map alone would show a surface for objects here, or nothing.
inline constexpr std::string_view kBareView = "bare";

/// Frame of poses that nobody measured: the first supporting plane before a camera taken as fixed.
inline constexpr const char* kAssumedFrame = "first_support";

/// The cloud of a scene as an image: CV_32FC3, metres, camera frame, NaN = none. To be read: it may be the
/// image that the cloud was made from.
cv::Mat cloud_points(const types::SceneCas& scene);
/// The normals of a scene likewise.
cv::Mat cloud_normals(const types::SceneCas& scene);
/// Makes images the cloud and the normals of a scene. Nobody may write to them afterwards.
void set_cloud_points(const types::SceneCas& scene, const cv::Mat& points);
void set_cloud_normals(const types::SceneCas& scene, const cv::Mat& normals);

/// A pixel of such an image.
inline Vector3d to_vector(const cv::Vec3f& pixel) {
  return {static_cast<double>(pixel[0]), static_cast<double>(pixel[1]), static_cast<double>(pixel[2])};
}
inline Eigen::Vector3f to_vector3f(const cv::Vec3f& pixel) {
  return {pixel[0], pixel[1], pixel[2]};
}

/// Pose of the depth camera; the Error of a scene without one names it.
Isometry3d map_from_camera(const types::Scene& scene);
/// Whether that pose was measured rather than assumed.
bool has_measured_pose(const types::Scene& scene);

using types::cluster_indices;
/// The points of a cluster in the map frame.
std::vector<Vector3d> cluster_points(const types::SceneCas& scene, const types::Cluster& cluster);

}  // namespace loci::perception
