#pragma once

#include <filesystem>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "nbv/planner.h"

namespace loci::nbv {

/// A top view of a decision: y up, BGR.
struct ViewImage {
  std::string name;   ///< file name without ending
  std::string title;  ///< what it shows, one line
  cv::Mat image;
};

/// The images of Fig. 7.2 and 7.4: known space and frontier; surfaces by height; C_F and C_O summed over
/// orientations; C per orientation; and C summed, with frontier (black dots), samples (blue arrows), the
/// sample that sees most frontier (green), the chosen one (red), the robot and its path. Costs: white = 0,
/// black = the largest. None when nothing is known.
std::vector<ViewImage> view_images(const ViewPlan& plan, const mapping::PlanarPose& robot);

/// Writes them as PNG into a folder; returns the files.
std::vector<std::filesystem::path> write_view_images(const ViewPlan& plan, const mapping::PlanarPose& robot,
                                                     const std::filesystem::path& folder);

}  // namespace loci::nbv
