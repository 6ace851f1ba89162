#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "apps/evaluate/normals/errors.h"
#include "mapping/base/options.h"
#include "mapping/base/progress.h"
#include "mapping/base/text/json_fwd.h"
#include "perception/annotators/structure/normals.h"

namespace loci::apps::normals_evaluation {

struct ComparisonOptions {
  int frames = 170;
  int reference_frames = 6;
  int real_frames = 30;
  double min_holes = 0.1;
  bool peers = true;
  int seed = 1;

  void declare(OptionTable& table);
};

/// All methods over one set of images.
struct SetResult {
  std::string name;  ///< "planes, 1/8 px", "redkitchen_rgbd"
  bool synthetic = false;
  double sigma_px = 0;  ///< of synthetic ones
  int frames = 0;
  double holes = 0;  ///< mean share of pixels without depth
  std::vector<std::pair<std::string, MethodErrors>> methods;

  const MethodErrors* find(const std::string& method) const;
};

inline constexpr const char* kBefore = "ours, before correction";
inline constexpr const char* kAfter = "ours, corrected";
inline constexpr const char* kReference = "PCL NormalEstimation";
inline constexpr const char* kIntegralImage = "PCL IntegralImage";
inline constexpr const char* kLinearLeastSquares = "PCL LinearLeastSquares";

struct Comparison {
  std::vector<SetResult> sets;

  std::string text() const;
  Json to_json() const;
};

/// Synthetic planes with disparity noise of 0, 1/16, 1/8 and 1/4 px, then the recordings' frames with enough
/// holes; one thread.
Comparison compare(const std::vector<std::filesystem::path>& recordings, const ComparisonOptions& options,
                   const perception::NormalOptions& normals, Progress& progress);

}  // namespace loci::apps::normals_evaluation
