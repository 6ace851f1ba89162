#pragma once

#include <opencv2/core.hpp>

#include "mapping/base/pose.h"
#include "mapping/sensor/camera.h"

namespace loci::perception {

/// Which pixel of the depth camera shows what a pixel of the colour camera shows, for everything on one plane
/// (normal · p = offset, depth camera's frame): the homography that the plane induces. Flat things on it move
/// by less than a pixel.
class PlaneRegistration {
 public:
  PlaneRegistration(const mapping::RgbdCamera& camera, const Vector3d& normal, double offset);

  /// An image of the depth camera as the colour camera would see it if it were painted on the plane (nearest
  /// pixel; `outside` where the depth image does not reach).
  cv::Mat seen_by_color(const cv::Mat& image, double outside) const;

 private:
  cv::Mat columns_, rows_;  ///< CV_32F, of the colour image's size
};

/// The pixels of the colour image that may show those of `box` of the depth image, some more included;
/// all of it when the box looks beside the plane.
cv::Rect box_in_color(const cv::Rect& box, const mapping::RgbdCamera& camera, const Vector3d& normal,
                      double offset);

/// The camera of a part of its image.
mapping::PinholeCamera cropped(const mapping::PinholeCamera& camera, const cv::Rect& box);

}  // namespace loci::perception
