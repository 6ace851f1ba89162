#pragma once

#include <cstdint>
#include <opencv2/core.hpp>

namespace loci::perception {

/// A perceptual hash (§3.2.2, §5.4.5; "pHash": Zauner 2010): 64 bits of the lowest frequencies of an image
/// (CV_8UC1 or CV_8UC3), each above or below the median. Size, brightness, contrast and noise hardly change
/// it. Colours do not count.
uint64_t perceptual_hash(const cv::Mat& image);

/// Bits in which two hashes differ, 0 to 64: a few for images of the same thing from the same side, about
/// 32 for others.
int hash_distance(uint64_t a, uint64_t b);

/// What the hash does not tell: mean colours of 4 x 4 cells of an image (CV_8UC3, BGR), CV_32FC3, Lab.
cv::Mat cell_colors(const cv::Mat& image);

}  // namespace loci::perception
