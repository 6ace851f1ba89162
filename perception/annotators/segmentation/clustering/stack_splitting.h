#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <vector>

#include "mapping/base/options.h"

namespace loci::perception {

/// When objects that stand upon each other are taken apart.
struct StackOptions {
  double stack_probability = 0.65;
  double layer_m = 0.012;
  double lid_m = 0.035;
  double cap_m = 0.05;

  void declare(OptionTable& table);
};

/// A cloud over one support, with what the image shows beside it. Frame: the support's plane, z = height;
/// metres.
struct StackCloud {
  const std::vector<Eigen::Vector3f>& points;
  const std::vector<Eigen::Vector3f>& normals;
  const std::vector<int>& pixels;     ///< row · width + column
  const std::vector<cv::Vec3b>& lab;  ///< colours, CIE Lab in 8 bits as OpenCV has it; empty = unknown
  Eigen::Vector2f viewpoint;          ///< where the camera is
  double focal_px;                    ///< of the camera
  const cv::Mat& image_points;        ///< CV_32FC3, the whole image in the camera frame, NaN = none
};

/// How an object changes at a height. Differences are those of what is seen right above it to what is seen
/// right below; *sigmas* are unsigned, in standard deviations of the measurement.
struct StackStep {
  float height = 0;                        ///< over the support, metres
  float above = 0, below = 0;              ///< height of what is seen of the object on either side, metres
  int points_above = 0, points_below = 0;  ///< pixels
  float width_above = 0, width_below = 0;  ///< next to the step, metres
  float left = 0, right = 0;               ///< by how much it reaches out further, metres
  float left_sigmas = 0, right_sigmas = 0;
  bool left_seen = false, right_seen = false;  ///< its own edge on both sides of the step, hidden by nothing
  float front = 0;                             ///< by how much its walls recede, metres
  float front_sigmas = 0;
  float color = 0;  ///< difference in Lab (lightness counts half) along three quarters of the walls
};

/// The heights at which an object (`members`: indices into the cloud) changes more than at those around them,
/// from the lowest on.
std::vector<StackStep> stack_steps(const StackCloud& cloud, const std::vector<size_t>& members);

/// Probability that what is above a step and what is below it are two objects, by their outlines, fronts and
/// colours. 0 for what is too small, for lids and for caps.
double stack_probability(const StackStep& step, const StackOptions& options);

/// Cuts an object at the heights where it is more probably two: the parts, from the lowest on. Without
/// colours nothing is cut.
std::vector<std::vector<size_t>> split_stack(const StackCloud& cloud, std::vector<size_t> members,
                                             const StackOptions& options);

}  // namespace loci::perception
