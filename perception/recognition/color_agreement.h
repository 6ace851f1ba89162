#pragma once

#include <opencv2/core.hpp>

namespace loci::perception {

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
