#pragma once

#include <opencv2/core.hpp>

#include "mapping/base/options.h"
#include "mapping/sensor/camera.h"
#include "perception/annotators/hypotheses/inclination_bias.h"

namespace loci::perception {

/// How a depth image is smoothed before normals are taken (§4.2.1). The defaults are a Kinect's.
struct NormalOptions {
  double disparity_quantum_px = 0.125;  ///< a of Eq. 4.4
  double noise_quanta = 2;              ///< the clamp is this many quanta wide to each side
  double baseline_m = 0.075;
  int iterations = 5;
  bool widen = true;
  double edge_px = 0.2;
  int half_reach_px = 4;
  bool correct_inclination = true;  ///< by the table that measure_inclination_bias() makes

  void declare(OptionTable& table);

  /// Narrower, for images of small things: the concave edge between two boxes that touch bends by no more
  /// than a step of the sensor's disparity. Large planes get somewhat noisier normals.
  static NormalOptions for_objects();
};

/// Depth with its noise smoothed away: a box filter of three pixels over disparity, first along rows, then
/// along columns, iterated; after each iteration every value is clamped to the interval that the measurement
/// allows (Eq. 4.4, which is symmetric in disparity). With `widen` the taps of iteration i are 2^i pixels
/// apart, so that 5 iterations reach as far as 341 of direct neighbours do. Taps that are not on one line
/// within edge_px of disparity are not mixed: a plane has linear disparity and is left as it is, outlines
/// stay where they are. `depth` is CV_32F in metres, NaN = none; so is the result, with values exactly where
/// `depth` has some.
cv::Mat smooth_depth(const cv::Mat& depth, const mapping::PinholeCamera& camera,
                     const NormalOptions& options = {});

/// CV_32FC3, metres, camera frame; NaN where there is no depth.
cv::Mat points_from_depth(const cv::Mat& depth, const mapping::PinholeCamera& camera);

/// Unit normals towards the camera (CV_32FC3, camera frame) of a smoothed depth image: the cross product of
/// the vectors between left and right, upper and lower neighbour, written in disparity, where a plane is
/// linear. A missing neighbour is replaced by the point itself; NaN where both of an axis are missing.
/// Neighbours 2 · half_reach_px away are taken where the surface is straight so far, otherwise direct ones,
/// of which one further than 5 % of the depth away counts as missing. `bias` is what the smoothing is known
/// to do to inclinations.
cv::Mat normals_from_depth(const cv::Mat& smoothed, const mapping::PinholeCamera& camera,
                           const NormalOptions& options = {}, const InclinationBias& bias = {});

struct DepthNormals {
  cv::Mat depth;    ///< as smooth_depth()
  cv::Mat normals;  ///< as normals_from_depth()
};
/// Both of the above in one go, which is faster. Memory of `result` is used again where it has the size.
void smooth_depth_and_normals(const cv::Mat& depth, const mapping::PinholeCamera& camera,
                              const NormalOptions& options, const InclinationBias& bias,
                              DepthNormals& result);

/// The bias of these options with this camera, from simulated planes (see InclinationBias). Deterministic;
/// some milliseconds.
InclinationBias measure_inclination_bias(const mapping::PinholeCamera& camera, const NormalOptions& options);

}  // namespace loci::perception
