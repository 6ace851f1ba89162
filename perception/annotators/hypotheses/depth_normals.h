#pragma once

#include <opencv2/core.hpp>

#include "mapping/base/options.h"
#include "mapping/sensor/camera.h"

namespace loci {

/// How a depth picture is smoothed before normals are taken (§4.2.1). The defaults are a Kinect's.
struct NormalOptions {
  double disparity_quantum_px = 0.125;  ///< a of Eq. 4.4
  double noise_quanta = 1.0;            ///< the clamp is this many quanta wide to each side
  double baseline_m = 0.075;
  int iterations = 10;
  double edge_px = 0.75;

  void declare(OptionTable& table);
};

/// Depth with its noise smoothed away: a 3-pixel box filter over disparity, iterated; between iterations each
/// value is clamped to the interval that the measurement allows (Eq. 4.4, which is symmetric in disparity).
/// Neighbours across a jump of more than edge_px of disparity are not mixed in, so outlines stay where they
/// are. `depth` is CV_32F in metres, NaN = none; so is the result, with values exactly where `depth` has
/// some.
cv::Mat smooth_depth(const cv::Mat& depth, const PinholeCamera& camera, const NormalOptions& options = {});

/// CV_32FC3, metres, camera frame; NaN where there is no depth.
cv::Mat points_from_depth(const cv::Mat& depth, const PinholeCamera& camera);

/// Unit normals towards the camera (CV_32FC3, camera frame) from the cross product of the vectors between
/// left and right, upper and lower neighbour. A missing neighbour is replaced by the point itself; NaN where
/// both of an axis are missing. A neighbour further than 5 % of the depth away counts as missing.
cv::Mat normals_from_points(const cv::Mat& points);

}  // namespace loci
