#pragma once

#include <opencv2/core.hpp>
#include <string>

#include "mapping/base/math/pose.h"
#include "mapping/base/options.h"
#include "mapping/render/render.h"
#include "mapping/sensor/camera.h"

namespace loci::perception {

/// The camera of an image of which every `stride`-th pixel is taken, in both directions.
inline mapping::PinholeCamera subsampled(const mapping::PinholeCamera& camera, int stride) {
  return {camera.width / stride, camera.height / stride, camera.fx / stride,
          camera.fy / stride,    camera.cx / stride,     camera.cy / stride};
}

/// How the pose of the camera is fitted to the map, frame by frame (§4.2.2: a localisation error turns walls
/// into objects).
struct PoseRefinementOptions {
  bool refine_pose = true;
  double pose_error_m = 0.1;
  double pose_error_deg = 5;

  void declare(OptionTable& table);
};

/// What a refinement did, and why it did not do more.
struct PoseRefinement {
  Isometry3d map_from_camera = Isometry3d::Identity();  ///< the given one where it is left as it is
  bool moved = false;
  /// Directions of motion, of six, that the surfaces in view determine; along the others the given pose
  /// stays (before a single wall: the two along the wall, and the turn in it).
  int constrained = 0;
  double explained_before = 0, explained_after = 0;  ///< share of the points that lie on the map's surfaces
  double shift_m = 0, turn_deg = 0;
  std::string verdict;  ///< in words
};

/// Fits the points of a depth image (CV_32FC3, camera frame, NaN = none) and their normals (likewise) to
/// what the scene, its joints as they are, looks like from the given pose: point to plane, pixel by pixel,
/// drawn anew after every step. Points that are not on the map (objects, people) lose their weight. The given
/// pose stays when it explains the image as well, when too little of the map is in view, and when the map
/// would have to be further away than the expected error.
PoseRefinement refine_pose(const cv::Mat& points, const cv::Mat& normals,
                           const mapping::PinholeCamera& camera, const Isometry3d& map_from_camera,
                           const mapping::RenderScene& scene, const PoseRefinementOptions& options,
                           int threads);

}  // namespace loci::perception
