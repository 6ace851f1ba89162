#pragma once

#include <opencv2/core.hpp>
#include <string_view>
#include <vector>

#include "mapping/base/math/pose.h"
#include "mapping/base/options.h"
#include "mapping/sensor/camera.h"
#include "perception/pipeline/annotator.h"

namespace loci::perception {

/// Labels of superpixels: CV_16U, number of the superpixel, 0 = none.
inline constexpr std::string_view kSuperpixelsView = "superpixels";

struct SuperpixelOptions {
  double radius_m = 0.02;
  int iterations = 5;
  double color = 0.4, normal = 0.3;

  void declare(OptionTable& table);
};

/// A patch of surface of about one size in space, wherever it is.
struct Superpixel {
  Vector3d position = Vector3d::Zero();  ///< mean of its points, camera frame, m
  Vector3d normal = Vector3d::Zero();
  Vector3d lab = Vector3d::Zero();  ///< mean colour, CIE Lab
  int pixels = 0;
};

struct Superpixels {
  cv::Mat labels;  ///< CV_16U, number of the superpixel + 1, 0 = none
  std::vector<Superpixel> all;
};

/// Depth-adaptive superpixels (§4.4; Weikersdorfer, Gossow, Beetz 2012): k-means over place in space,
/// direction of the surface and colour, from seeds that are as dense in the image as patches of one size
/// are there. Each is connected in the image. `points`, `normals`: CV_32FC3, camera frame, NaN = none;
/// `lab`: CV_32FC3, colour of each of these pixels in CIE Lab, NaN = none (then colour does not count).
Superpixels find_superpixels(const cv::Mat& points, const cv::Mat& normals, const cv::Mat& lab,
                             const mapping::PinholeCamera& camera, const SuperpixelOptions& options);

/// The colour image as the depth camera's pixels see it, in CIE Lab: CV_32FC3, NaN where unknown.
cv::Mat lab_of_points(const cv::Mat& points, const cv::Mat& color, const mapping::RgbdCamera& camera);

/// How much each superpixel stands out from what surrounds it (region contrast after Cheng et al. 2011, with
/// distances in space): mean difference of colour to others, those within `reach` (m) counting most. 0 to 1,
/// the most salient is 1.
std::vector<double> saliency(const Superpixels& superpixels, double reach);

/// A ball around superpixels that stand out and lie side by side.
struct SalientBall {
  Vector3d center = Vector3d::Zero();  ///< camera frame, m
  double radius = 0;
  double saliency = 0;  ///< of its most salient part
};

/// From the most salient on, as long as they stand out from most of the scene: superpixels at least `share`
/// as salient as the peak, connected by steps of at most `step` metres. Balls above `max_radius` are left
/// out, and peaks that lie in a ball before.
std::vector<SalientBall> salient_balls(const Superpixels& superpixels, const std::vector<double>& saliency,
                                       double share, double step, double max_radius, size_t most);

/// Where the hypotheses of SaliencyDetector are indexed.
inline constexpr std::string_view kSaliencyView = "saliency";

/// Parts the image into patches of about one size in space, in the view "superpixels".
class SuperpixelExtractor : public Annotator {
 public:
  AnnotatorDescriptor descriptor() const override;
  void declare(OptionTable& table) override { options_.declare(table); }
  void process(cas::Cas& cas, Context& context) override;

 private:
  SuperpixelOptions options_;
};

/// Balls around what stands out by its colour: TFLinkSphereROI in the map frame, in the index of the view
/// "saliency", and among the hypotheses of the clusters most of whose points they hold.
class SaliencyDetector : public Annotator {
 public:
  AnnotatorDescriptor descriptor() const override;
  void declare(OptionTable& table) override;
  void process(cas::Cas& cas, Context& context) override;

 private:
  SuperpixelOptions superpixels_;
  double reach_m_ = 0.25, share_ = 0.6, max_radius_m_ = 0.2;
  int most_ = 10;
};

}  // namespace loci::perception
