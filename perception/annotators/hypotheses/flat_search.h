#pragma once

#include <vector>

#include "perception/annotators/hypotheses/flat_objects.h"
#include "perception/annotators/hypotheses/plane_registration.h"

namespace loci::perception {

/// Standard deviation of single pixels' heights (CV_32F, metres, NaN = none), from neighbours on the same
/// surface.
double pixel_noise(const cv::Mat& heights);

/// The two stages of find_flat_objects() over one image, and over what is left of it.
class FlatSearch {
 public:
  FlatSearch(const cv::Mat& depth, const cv::Mat& color, const mapping::RgbdCamera& camera,
             const FlatSurface& surface, const FlatOptions& options);

  /// Things of which at least a quarter is higher than `object_m`, with the pixels of both images.
  /// `heights`: over the surface, CV_32F, metres, of the depth image.
  std::vector<FlatObject> find(const cv::Mat& heights, double object_m) const;
  /// What was found, and what is next to it, is not looked at again.
  void leave_out(const std::vector<FlatObject>& objects);
  /// Depth pixels that are looked at, CV_8U.
  const cv::Mat& open_ground() const { return open_; }

 private:
  double pixel_area(const cv::Point& pixel) const;
  cv::Mat near(const cv::Mat& seeds) const;
  void assign_depth_pixels(const cv::Mat& heights, const cv::Mat& object_of_color,
                           std::vector<FlatObject>& objects) const;

  const cv::Mat& depth_;
  const mapping::RgbdCamera& camera_;
  const FlatSurface& surface_;
  const FlatOptions& options_;
  PlaneRegistration registration_;
  cv::Mat bin_of_color_;
  cv::Mat open_;
};

}  // namespace loci::perception
