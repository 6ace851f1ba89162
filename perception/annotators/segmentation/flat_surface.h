#pragma once

#include <filesystem>
#include <opencv2/core.hpp>
#include <vector>

#include "mapping/base/math/pose.h"
#include "mapping/base/options.h"
#include "mapping/sensor/camera.h"

namespace loci::perception {

/// How flat objects are told from the surface below them (§4.3).
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
  double min_contrast = 1;
  int bins = 32;

  void declare(OptionTable& table);
};

/// A surface on which flat objects may lie, as the depth camera sees it.
struct FlatSurface {
  Vector3d normal = -Vector3d::UnitY();  ///< unit, up, camera frame
  double offset = 0;                     ///< normal · p = offset, metres
  cv::Mat inside;                        ///< CV_8U, depth pixels that may show the surface or flat objects
  cv::Mat empty_depth;  ///< CV_32F, metres: SurfaceCalibration::mean(); an empty Mat = not calibrated
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

/// The mean of a SurfaceCalibration as a 16-bit PNG in tenths of a millimetre, 0 = none.
void write_surface(const std::filesystem::path& path, const cv::Mat& empty_depth);
cv::Mat read_surface(const std::filesystem::path& path);

/// Heights over a surface: CV_32F, metres, of the depth image, NaN = none. `bent` and `uneven` are smoothed
/// over as many pixels as bring the noise of the image below noise_m; with a calibration both are over the
/// empty surface.
struct SurfaceHeights {
  cv::Mat raw;     ///< of single pixels over the plane (or the empty surface)
  cv::Mat bent;    ///< over the surface that most pixels show, bent as a whole
  cv::Mat uneven;  ///< over the lower envelope of these heights, wider than background_m, where `bent` fails
};
SurfaceHeights measure_heights(const cv::Mat& depth, const mapping::PinholeCamera& camera,
                               const FlatSurface& surface, const FlatOptions& options);

/// Standard deviation of the heights of single pixels, from neighbours on the same surface.
double pixel_noise(const cv::Mat& heights);

/// Heights over a plane (CV_32F, metres, image of a depth camera, NaN = none) made heights over the surface
/// near the plane that bends as a whole: a polynomial of second degree, fitted to what most of the pixels
/// show. It takes away what a sensor distorts and how a board sags, and no object, however wide.
cv::Mat over_bent_surface(const cv::Mat& heights, const mapping::PinholeCamera& camera,
                          const Vector3d& normal, double offset);

/// Whether an object (`pixels` of the depth image) lies higher than what is next to it by at least `step_m`
/// along its border, and rises along nearly all of it. The border is cut into short pieces, each compared
/// with the ground right beside it, so that neither slopes nor waves of the surface matter, and what is only
/// painted (paper, shadows, seams between boards) does not rise. `heights`: of single pixels, not smoothed.
/// `ground` (CV_8U): pixels that may be compared with.
bool rises_all_around(const cv::Mat& heights, const std::vector<int>& pixels, const cv::Mat& ground,
                      double step_m);

}  // namespace loci::perception
