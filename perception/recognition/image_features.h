#pragma once

#include <array>
#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

namespace loci::perception {

/// A SIFT descriptor as RootSIFT (Arandjelovic and Zisserman, CVPR 2012) in bytes: 512 times the square root
/// of each share, so that the squared distance of two lies between 0 and 2 · 512².
using Descriptor = std::array<uint8_t, 128>;

/// Squared Euclidean distance.
int squared_distance(const Descriptor& a, const Descriptor& b);

/// Where a descriptor was taken, in pixels of the image as it was given.
struct Keypoint {
  float x = 0, y = 0;
  float size = 0;   ///< diameter of the neighbourhood
  float angle = 0;  ///< radian, of the gradient that it is upright to
};

struct ImageFeatures {
  int width = 0, height = 0;  ///< of the image as it was given
  std::vector<Keypoint> keypoints;
  std::vector<Descriptor> descriptors;  ///< one per key point
};

/// SIFT features of an image (CV_8UC3, BGR, or CV_8UC1). It is scaled so that its longer side has `side`
/// pixels first: what small and large images show is then described at like scales. The strongest `most`
/// are kept. A uniform image has none.
ImageFeatures image_features(const cv::Mat& image, int side, int most);

/// A perceptual hash (§3.2.2, §5.4.5; "pHash": Zauner 2010): 64 bits of the lowest frequencies of an image
/// (CV_8UC1 or CV_8UC3), each above or below the median. Size, brightness, contrast and noise hardly change
/// it. Colours do not count.
uint64_t perceptual_hash(const cv::Mat& image);

/// Bits in which two hashes differ, 0 to 64: a few for images of the same object from the same side, about
/// 32 for others.
int hash_distance(uint64_t a, uint64_t b);

/// An image (BGR, CV_8UC3, or CV_32FC3 of 0 to 1) in CIE Lab, the type of the image. For any thread.
cv::Mat lab_of(const cv::Mat& image);

/// What the hash does not tell: mean colours of 4 x 4 cells of an image (CV_8UC3, BGR), CV_32FC3, Lab.
cv::Mat cell_colors(const cv::Mat& image);

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

/// The colours of an image without its brightness, small: CV_8UC3 with a and b of CIE Lab, and 255 where the
/// image is not blown out to white (the background of a catalogue's images). The longer side has `side`
/// cells.
cv::Mat chroma_of(const cv::Mat& image, int side);

/// How alike the colours of two images are where one lies on the other, 0 to 1: the mean over the coloured
/// cells of a Gaussian of the distance. `to_from_from` maps pixels of the first image, of size `from_size`,
/// to pixels of the second. 0.5 when too little of it is coloured or in view.
double color_agreement(const cv::Mat& from, const cv::Size& from_size, const cv::Mat& to,
                       const cv::Size& to_size, const cv::Matx23d& to_from_from);

}  // namespace loci::perception
