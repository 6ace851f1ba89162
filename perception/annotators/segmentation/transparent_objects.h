#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "mapping/base/math/pose.h"
#include "mapping/base/options.h"
#include "mapping/sensor/camera.h"
#include "perception/pipeline/annotator.h"

namespace loci::perception {

/// What a hole in the depth image must be like to be taken for something transparent (§4.3).
struct TransparentOptions {
  double min_width_m = 0.03;
  double max_width_m = 0.15;
  double min_height_m = 0.04;
  double max_height_m = 0.35;
  double surrounded = 0.7;
  double baseline_m = 0.075;
  double surface_m = 0.012;

  void declare(OptionTable& table);
};

/// A surface on which glasses may stand, as the depth camera sees it.
struct HoleSurface {
  Vector3d normal = -Vector3d::UnitY();  ///< unit, up, camera frame
  double offset = 0;                     ///< normal · p = offset, metres
  cv::Mat inside;                        ///< CV_8U, depth pixels within its outline
  cv::Mat taken;                         ///< CV_8U, depth pixels of what was found already
};

/// Something upright that the depth camera looked through or was blinded by.
struct TransparentCandidate {
  std::vector<int> pixels;           ///< of the hole, row · width + column, ascending
  Vector3d foot = Vector3d::Zero();  ///< middle of its foot on the surface, camera frame, metres
  double width = 0;                  ///< metres
  double height = 0;                 ///< metres, if it stands upright
  double surrounded = 0;             ///< share of what is around the hole that is the surface itself
};

/// Holes in `depth` (CV_32F, metres, NaN = none) on a surface that are as large as glasses, bottles or jars.
/// Around a hole the surface itself must be seen, and the shadows that a sensor with a projector beside its
/// camera leaves where one row jumps from near to far are none.
std::vector<TransparentCandidate> find_transparent(const cv::Mat& depth, const mapping::PinholeCamera& camera,
                                                   const HoleSurface& surface,
                                                   const TransparentOptions& options);

/// Holes in depth as candidates for glasses: clusters without points, with a box, a region of the colour
/// image, and a classification of kind "material" that says "transparent" and how much speaks for it.
class TransparentExtractor : public Annotator {
 public:
  static constexpr const char* kName = "TransparentExtractor";
  AnnotatorDescriptor descriptor() const override;
  void declare(OptionTable& table) override;
  void process(cas::Cas& cas, Context& context) override;

 private:
  TransparentOptions options_;
};

}  // namespace loci::perception
