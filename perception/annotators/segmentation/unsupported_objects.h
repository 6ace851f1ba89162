#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "mapping/base/math/pose.h"
#include "mapping/base/options.h"
#include "mapping/sensor/camera.h"
#include "perception/annotators/segmentation/clustering/convex_parts.h"
#include "perception/pipeline/annotator.h"

namespace loci::perception {

/// What counts as an object where nothing shows what it stands on.
struct UnsupportedOptions {
  double nearest_m = 0.25;
  double farthest_m = 1.0;
  double tolerance_m = 0.012;
  double min_area_m2 = 0.0015;
  double max_extent_m = 0.45;
  ConvexPartsOptions parts;

  void declare(OptionTable& table);
};

/// Objects in bins and on shelves whose floor is not seen, as pixels (row · width + column, ascending) of the
/// image: what is convex, of one colour where colours divide it in two, of a size to handle, not cut off by
/// the image, and closed: along its outline it is in front of what is beside and above it. Walls are behind
/// what stands before them. `points`, `normals`: CV_32FC3, camera frame, NaN = none; `lab`: CV_32FC3, colour
/// of these pixels in CIE Lab, NaN = none, or empty; `up`: unit, camera frame.
std::vector<std::vector<int>> find_unsupported_objects(const cv::Mat& points, const cv::Mat& normals,
                                                       const cv::Mat& lab,
                                                       const mapping::PinholeCamera& camera,
                                                       const Vector3d& up, const UnsupportedOptions& options,
                                                       int threads = 1);

/// Objects of frames without a support and without a map that are close-ups: at least half of what is
/// measured is nearer than farthest_m. Further away, depth cameras do not resolve the edges by which objects
/// come apart.
class UnsupportedObjectExtractor : public Annotator {
 public:
  static constexpr const char* kName = "UnsupportedObjectExtractor";
  AnnotatorDescriptor descriptor() const override;
  void declare(OptionTable& table) override { options_.declare(table); }
  void process(cas::Cas& cas, Context& context) override;

 private:
  UnsupportedOptions options_;
};

}  // namespace loci::perception
