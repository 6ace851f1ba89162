#pragma once

#include <array>
#include <opencv2/core.hpp>
#include <optional>

#include "mapping/base/options.h"
#include "mapping/sensor/camera.h"
#include "perception/annotators/structure/disparity_kernels.h"
#include "perception/pipeline/annotator.h"

namespace loci::perception {

/// By how much estimated normals lean too little or too much, by their inclination to the sensor's plane
/// (§4.2.1.1): a table in bins of 5°, as in Fig. 4.4, and its inverse, a rotation about z × n (Eq. 4.6). The
/// default corrects nothing.
class InclinationBias {
 public:
  static constexpr int kBins = 18;
  static constexpr double kBinDeg = 5;
  using Table = std::array<double, kBins>;

  InclinationBias() = default;
  /// `correction_deg` of a bin is what is added to an estimated inclination in its middle; between middles it
  /// is interpolated, and it vanishes at 0 and 90°.
  explicit InclinationBias(const Table& correction_deg);

  const Table& correction_deg() const { return correction_deg_; }
  /// The rotation as what is added to the z of a unit normal, by the cosine of its inclination.
  const CosineTable& tilt() const { return tilt_; }

 private:
  Table correction_deg_ = {};
  CosineTable tilt_ = {};
};

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

  /// Narrower, for images of small objects: the concave edge between two boxes that touch bends by no more
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

/// Smoothed depth, cloud and normals of the depth image (§4.2.1).
class NormalEstimator : public Annotator {
 public:
  AnnotatorDescriptor descriptor() const override;
  void declare(OptionTable& table) override { options_.declare(table); }
  void process(cas::Cas& cas, Context& context) override;

 private:
  NormalOptions options_ = NormalOptions::for_objects();
  std::optional<InclinationBias> bias_;  ///< of the camera that was seen last
  mapping::PinholeCamera bias_camera_;
};

}  // namespace loci::perception
