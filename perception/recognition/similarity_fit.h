#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "perception/recognition/image_features.h"

namespace loci {

/// That a key point of one image (a catalogue's) looks like one of another (a query).
struct Correspondence {
  Keypoint from, to;
  double weight = 0;
};

/// A map between images and who agrees with it.
struct ImageFit {
  cv::Matx23d to_from_from = cv::Matx23d::zeros();  ///< affine, pixels
  std::vector<size_t> inliers;                      ///< numbers of correspondences, ascending
  double weight = 0;                                ///< of the inliers
};

/// The affine map that most correspondences, by weight, agree with. Every correspondence of SIFT key points
/// is a similarity by itself (Lowe 2004, §7.3): all are tried, so nothing is random; the best is refined to
/// an affine map. `tolerance` is in pixels of `to`. A key point of either image counts once. No inliers when
/// fewer than three agree.
ImageFit fit_images(const std::vector<Correspondence>& correspondences, double tolerance);

}  // namespace loci
