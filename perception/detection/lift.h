#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "mapping/base/math/pose.h"
#include "mapping/base/math/tally.h"
#include "mapping/sensor/camera.h"
#include "perception/detection/detection_set.h"

namespace loci::perception {

struct KeyPoint3D {
  std::string name;
  Vector3d position = Vector3d::Zero();  ///< camera frame, metres
};

/// The surface that a region of the colour image shows.
struct LiftedRegion {
  std::vector<int> pixels;             ///< of the depth image, row · width + column, ascending
  std::vector<KeyPoint3D> key_points;  ///< those with depth
  bool at_image_border = false;        ///< cut off by the edge of the colour image
};

/// Either the surface, or why there is none.
struct LiftResult {
  std::optional<LiftedRegion> region;
  Reason reason = Reason::no_depth_inside;  ///< without a region
};

/// What lift_region() needs of a frame, once for all of its regions.
struct LiftFrame {
  mapping::RgbdCamera camera;
  cv::Mat points;              ///< CV_32FC3, depth camera's frame, metres, NaN = no measurement
  cv::Mat explained;           ///< CV_8U, 255 = left out: a surface of the map; empty = none
  std::optional<Vector3d> up;  ///< unit, camera frame, where it is known
  cv::Mat in_color;            ///< CV_32FC2, position in the colour image as detectors give it, NaN = none
};

/// The points of a depth image (CV_32F, metres) as CV_32FC3, NaN = no measurement.
cv::Mat points_of(const cv::Mat& depth, const mapping::PinholeCamera& camera);

/// `depth`: CV_32F, metres. `explained` may be empty.
LiftFrame lift_frame(const cv::Mat& depth, const mapping::RgbdCamera& camera, const cv::Mat& explained,
                     const std::optional<Vector3d>& up);
/// The same from points (CV_32FC3).
LiftFrame lift_frame_of_points(const cv::Mat& points, const mapping::RgbdCamera& camera,
                               const cv::Mat& explained, const std::optional<Vector3d>& up);

/// The pixels of the depth image that fall into a region, ascending.
std::vector<int> pixels_in(const LiftFrame& frame, const ImageRegion& region);

/// The pixels that a map explains: those not nearer than what the map alone would measure, CV_8U, 255. Both
/// depths CV_32F, NaN = nothing.
cv::Mat explained_by(const cv::Mat& depth, const cv::Mat& map_depth);

/// The depth pixels of the object in a region: around the mode of the depths inside, as far as they are
/// connected in depth. Of a box without mask the surface that the object stands on is left out.
LiftResult lift_region(const LiftFrame& frame, const ImageRegion& region,
                       const std::vector<KeyPoint2D>& key_points = {});

}  // namespace loci::perception
