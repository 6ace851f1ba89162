#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "mapping/sensor/camera.h"

namespace loci::apps::normals_evaluation {

/// Normals of one image and what they cost.
struct Estimate {
  cv::Mat normals;     ///< CV_32FC3, NaN where there is none
  double seconds = 0;  ///< of this thread's CPU time, without copies from and to cv::Mat
};

/// A way to estimate normals from a depth image (CV_32F, metres), on one thread.
class Method {
 public:
  virtual ~Method() = default;
  virtual Estimate estimate(const cv::Mat& depth, const mapping::PinholeCamera& camera) = 0;
};

/// pcl::NormalEstimation (kd-tree, 20 neighbours; "the reference implementation" of §4.2.1).
std::unique_ptr<Method> pcl_normal_estimation();
/// pcl::IntegralImageNormalEstimation as constructed: AVERAGE_3D_GRADIENT.
std::unique_ptr<Method> pcl_integral_image();
/// pcl::LinearLeastSquaresNormalEstimation as constructed.
std::unique_ptr<Method> pcl_linear_least_squares();

}  // namespace loci::apps::normals_evaluation
