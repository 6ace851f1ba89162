#pragma once

#include <opencv2/core.hpp>

#include "mapping/base/math/random.h"
#include "mapping/sensor/camera.h"

namespace loci::apps::normals_evaluation {

/// A depth image and the normals that its surfaces truly have.
struct Surfaces {
  cv::Mat depth;  ///< CV_32F, metres, NaN = no measurement
  cv::Mat truth;  ///< CV_32FC3, unit normals towards the camera; NaN where nothing is known
};

/// What a structured-light sensor does to disparity.
struct DisparityNoise {
  double baseline_m = 0.075;
  double quantum_px = 0.125;
  double sigma_px = 0;  ///< Gaussian, before the quantisation
};

/// The synthetic scenes of §4.2.1.1: the image falls into random planar patches that lean by 0 to 75
/// degrees against the sensor's plane, 0.7 to 3 m away. Nothing is measured beyond 0.5 to 5 m.
Surfaces planar_patches(const mapping::PinholeCamera& camera, const DisparityNoise& noise, Random& random);

/// Planes of a real depth image, without using any estimated normal: a plane is linear in disparity, so
/// squares of 48 pixels are fitted robustly there, and count as flat when they have depth in half of their
/// pixels and nearly all of it lies on the plane. Their fit averages over more than a thousand
/// measurements, which no normal does; it is no truth, but about ten times as sure as what is judged by it.
Surfaces flat_areas(const cv::Mat& depth, const mapping::PinholeCamera& camera, const DisparityNoise& sensor);

/// Share of pixels without depth.
double share_of_holes(const cv::Mat& depth);

}  // namespace loci::apps::normals_evaluation
