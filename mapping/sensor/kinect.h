#pragma once

#include <opencv2/core.hpp>

#include "mapping/base/math/random.h"
#include "mapping/base/options.h"
#include "mapping/sensor/camera.h"

namespace loci::mapping {

/// Both cameras of a Kinect v1: 640 x 480, f 585 px for depth, 528 px for colour, which is 22 mm to the
/// right.
RgbdCamera kinect_camera();

/// How a Kinect v1 measures: a pattern projected from 75 mm to the right of the depth camera is found again
/// as a disparity.
struct KinectModel {
  double range_min_m = 0.5;
  double range_max_m = 5.0;
  double baseline_m = 0.075;
  double disparity_sigma_px = 0.1;
  double disparity_step_px = 0.125;
  double distortion_per_m = 0.003;
  double incidence_max_deg = 75;
  double edge_probability = 0.5;
  int edge_width_px = 2;
  double edge_jump = 0.02;
  bool shadow = true;
  double color_sigma = 3;

  void declare(OptionTable& table);
};

/// The noise-free image of a depth camera, as the sensor would measure it.
///   depth   CV_32F, z in metres, NaN = nothing there
///   normal  CV_32FC3, unit, camera frame; zero = unknown (no incidence check there)
/// Row v draws from random.fork(v) only: the same bytes on any number of threads (0 = all cores).
cv::Mat measured_by_kinect(const cv::Mat& depth, const cv::Mat& normal, const PinholeCamera& camera,
                           const KinectModel& model, const Random& random, int threads = 1);

/// Adds the colour camera's noise, N(0, color_sigma) of 255 per channel, to a CV_8UC3 image.
void add_color_noise(cv::Mat& color, const KinectModel& model, const Random& random, int threads = 1);

/// Value in [-1, 1] of the fixed smooth distortion field at a pixel.
double distortion_field(const PinholeCamera& camera, int u, int v);

}  // namespace loci::mapping
