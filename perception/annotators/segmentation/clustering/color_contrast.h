#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>

namespace loci::perception {

/// How much the colours of a region differ from those of the ground around it: the distance of the means over
/// the standard deviation of a pixel, so that noise and texture have none. 0 where no ground is seen.
/// `color`: CV_8UC3, BGR; `mask`: CV_8U, of the size of `box`, 255 = region; `ground`: CV_8U, of the size of
/// `color`.
double color_contrast(const cv::Mat& color, const cv::Rect& box, const cv::Mat& mask, const cv::Mat& ground);

/// Distance of two colours in CIE Lab (8 bits, as OpenCV has it). Lightness counts half: surfaces that face
/// another way are brighter or darker.
inline float lab_distance(const Eigen::Vector3f& a, const Eigen::Vector3f& b) {
  return (b - a).cwiseProduct(Eigen::Vector3f(0.5f, 1, 1)).norm();
}

/// Whether two mean colours are those of two objects rather than of one in light and shadow.
inline bool is_other_color(const Eigen::Vector3f& a, const Eigen::Vector3f& b) {
  constexpr float kOther = 30;
  return lab_distance(a, b) > kOther;
}

inline Eigen::Vector3f lab_vector(const cv::Vec3b& lab) {
  return {static_cast<float>(lab[0]), static_cast<float>(lab[1]), static_cast<float>(lab[2])};
}

}  // namespace loci::perception
