#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "mapping/base/options.h"
#include "mapping/base/pose.h"
#include "mapping/sensor/camera.h"

namespace loci::perception {

/// How flat things are told from the surface below them (§4.3).
struct FlatOptions {
  double table_m = 0.002;
  double object_m = 0.008;
  double thin_m = 0.0035;
  double step_m = 0.003;
  double max_height_m = 0.03;
  double noise_m = 0.0008;
  double background_m = 0.2;
  double reach_m = 0.02;
  double min_area_m2 = 0.0003;
  double max_extent_m = 0.5;
  int bins = 32;

  void declare(OptionTable& table);
};

/// A surface on which flat things may lie, as the depth camera sees it.
struct FlatSurface {
  Vector3d normal = -Vector3d::UnitY();  ///< unit, up, camera frame
  double offset = 0;                     ///< normal · p = offset, metres
  cv::Mat inside;                        ///< CV_8U, depth pixels that may show the surface or flat things
  cv::Mat empty_depth;  ///< CV_32F, metres: SurfaceCalibration::mean(); an empty Mat = not calibrated
};

struct FlatObject {
  cv::Rect box;             ///< in the colour image
  cv::Mat mask;             ///< CV_8U, of the box's size: 255 = object
  std::vector<int> pixels;  ///< of the depth image, row · width + column, ascending
  double height = 0;        ///< median over the surface, metres
};

/// The empty workspace before a camera that stands still: the mean of its depth images, pixel by pixel, so
/// that the unevenness of the surface and the distortion of the sensor both are in it. (§4.3 keeps deviations
/// from a plane in a rectified top view; the distortion belongs to the pixel, and nothing needs interpolation
/// here.)
class SurfaceCalibration {
 public:
  /// CV_32F, metres, NaN = none; all of one size.
  void add(const cv::Mat& depth);
  int frames() const { return frames_; }
  /// CV_32F, metres; NaN where fewer than half of the images measured anything.
  cv::Mat mean() const;

 private:
  int frames_ = 0;
  cv::Mat sum_;    ///< CV_64F, of inverse depth: disparity is what has even noise
  cv::Mat count_;  ///< CV_32S
};

/// Heights over the surface (CV_32F, metres, depth image, NaN = none), smoothed over as many pixels as
/// bring the noise of this image below noise_m. Without calibration the surface is what most
/// pixels show, bent as a whole; where that does not explain it, the lower envelope of the image's own
/// heights, wider than background_m.
cv::Mat heights_over_surface(const cv::Mat& depth, const mapping::PinholeCamera& camera,
                             const FlatSurface& surface, const FlatOptions& options);

/// An image of the depth camera as the colour camera would see it if it were painted on the surface's plane
/// (nearest pixel; `outside` where the depth image does not reach). Flat things move by less than a pixel.
cv::Mat seen_by_color(const cv::Mat& image, const mapping::RgbdCamera& camera, const FlatSurface& surface,
                      double outside);

/// Flat things in two stages: what is certainly surface (below table_m) and certainly object (above object_m)
/// trains histograms of hue and saturation, anew for every image, so that the light may change; every pixel
/// of the colour image, which may be the larger one, is then decided by its colour and its height together.
/// What is left is searched once more for things that are too thin to be certain (above thin_m, over the
/// plane as it bends as a whole): these must rise over what is next to them by step_m along their whole
/// border, see rises_all_around(). `color`: CV_8UC3 of camera.color's size.
std::vector<FlatObject> find_flat_objects(const cv::Mat& depth, const cv::Mat& color,
                                          const mapping::RgbdCamera& camera, const FlatSurface& surface,
                                          const FlatOptions& options);

}  // namespace loci::perception
