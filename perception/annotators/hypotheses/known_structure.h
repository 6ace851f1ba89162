#pragma once

#include <opencv2/core.hpp>
#include <string_view>
#include <vector>

#include "mapping/base/options.h"
#include "mapping/sensor/pixel_kind.h"
#include "perception/annotators/hypotheses/known_map.h"

namespace loci::perception {

/// How points are taken for known structure (§4.2.2).
struct KnownStructureOptions {
  std::vector<std::string> regions = {"counter*", "table*",  "island*", "shelf*",
                                      "desk*",    "*_shelf", "*_top",   "*drawer*bottom"};
  double epsilon_m = 0.02;
  double region_height_m = 1.0;
  double support_tolerance_m = 0.035;
  double margin_m = 0.03;

  void declare(OptionTable& table);
};

/// A region of interest in one frame: the box above a surface.
struct Region {
  const SupportSurface* surface = nullptr;
  Isometry3d map_from_top = Isometry3d::Identity();  ///< with the joints of the frame
  int pixels = 0;                                    ///< that fell into it
};

/// View of the scene with the kind of each pixel: CV_8U, mapping::PixelKind.
inline constexpr std::string_view kStructureView = "structure";

struct KnownStructure {
  cv::Mat region;     ///< CV_16U: 1 + index into regions; 0 = known structure, or in no region
  cv::Mat map_depth;  ///< CV_32F: what the map alone would measure, NaN = nothing
  cv::Mat kind;       ///< CV_8U: mapping::PixelKind
  std::vector<Region> regions;
  int known = 0;    ///< pixels removed because a known surface explains them
  int outside = 0;  ///< pixels in no region
};

/// Compares a depth image with what the map, its joints as they are now, would look like from
/// `map_from_camera`. A point is known structure when d_model − z ≤ ε (one-sided: what lies behind a known
/// surface goes too; ε grows with the noise of the depth). The tops of the surfaces themselves stay: within
/// the tolerance around a surface's height a point belongs to its region, so that neither flat objects nor a
/// map that is some centimetres off cost anything. `points`: CV_32FC3, camera frame.
KnownStructure find_known_structure(const cv::Mat& points, const mapping::PinholeCamera& camera,
                                    const Isometry3d& map_from_camera, KnownMap& map,
                                    const std::vector<SupportSurface>& surfaces, const JointState& joints,
                                    const KnownStructureOptions& options, int threads);

}  // namespace loci::perception
