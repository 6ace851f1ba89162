#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "mapping/sensor/frame.h"

namespace loci::mapping {

/// Lens distortion as ROS and OpenCV have it.
struct Distortion {
  enum class Model { none, plumb_bob, rational_polynomial, equidistant };
  Model model = Model::none;
  /// plumb_bob: k1 k2 p1 p2 [k3]; rational_polynomial: k1 k2 p1 p2 k3 k4 k5 k6; equidistant: k1 k2 k3 k4.
  std::vector<double> coefficients;

  /// Where a ray (x, y, 1) meets the image plane at z = 1 after the lens.
  Vector2d distorted(const Vector2d& ray) const;
};

/// A model by name: "plumb_bob" (also "brown_conrady"), "rational_polynomial", "equidistant" (also "fisheye",
/// "kannala_brandt4"), or "" and "none". No distortion when all coefficients are 0. Error for another model,
/// a wrong number of coefficients or values that are not finite.
Distortion distortion_from(const std::string& model, const std::vector<double>& coefficients,
                           const FileLocation& location);

/// Turns images of a lens with distortion into those of its pinhole. The map is computed once.
class Rectifier {
 public:
  Rectifier() = default;  ///< leaves images as they are
  Rectifier(const PinholeCamera& camera, const Distortion& distortion)
      : Rectifier(camera, distortion, camera) {}
  /// Into images of `camera` from those of a `lens` of another focal length or centre, and as many pixels.
  Rectifier(const PinholeCamera& camera, const Distortion& distortion, const PinholeCamera& lens);

  /// Bilinear; black where the lens saw nothing.
  cv::Mat color(const cv::Mat& image) const;
  /// Bilinear within a surface, the nearest pixel at edges and holes: no depth stands between two surfaces.
  cv::Mat depth(const cv::Mat& image) const;

 private:
  cv::Mat source_;  ///< CV_32FC2 position in the stored image of each pixel; empty = identity
};

/// z of the points at distance 1 along the ray of each pixel, CV_32F: turns distances into z.
cv::Mat z_along_rays(const PinholeCamera& camera);

/// What is done to each frame between file and program.
struct ImageCorrection {
  Rectifier depth, color;
  cv::Mat z_of_distance;  ///< of depth that is the distance along rays: z_along_rays(); else empty
  bool close_grid_holes = false;

  void apply(RgbdFrame& frame) const;
};

/// Whether depth was warped to another camera without closing the holes that this leaves: most pixels
/// without depth have near neighbours with depth on opposite sides that agree.
bool has_grid_holes(const cv::Mat& depth);

/// Gives pixels without depth the mean of the nearest ones on opposite sides, up to 2 pixels away in a row, a
/// column or a diagonal, where these lie on one surface.
void close_grid_holes(cv::Mat& depth);

}  // namespace loci::mapping
