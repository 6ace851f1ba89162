#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "perception/recognition/image_features.h"

namespace loci::perception {

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

/// log10 of the number of fits as good as this one that chance is expected to bring when so many images are
/// tried ("a contrario": Moisan and Stival, IJCV 2004): correspondences that are strewn over an image of size
/// `to` agree with a map by place, turn and scale as often as a binomial distribution says. What lies
/// together counts once, and three make any map.
double log_false_alarms(const std::vector<Correspondence>& correspondences, const ImageFit& fit,
                        double tolerance, const cv::Size& to, size_t images);

}  // namespace loci::perception
