#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

namespace loci::perception {

struct Barcode {
  std::string symbology;  ///< "EAN-13", "EAN-8", "UPC-A", "UPC-E", "QR", "Code 128", …, as people write them
  std::string code;       ///< what it says
  cv::Rect region;        ///< pixels of the image
  /// How the image had to be changed for it, in words; empty = not at all.
  std::string preparation;
};

/// Reads barcodes and QR codes with ZBar, from an image (CV_8UC1 or CV_8UC3 BGR). What ZBar does not read in
/// the image as it is, is tried sharpened, with even light, as black and white, at other scales and turned;
/// the first preparation that yields a code ends the search (`thorough` = false: only the image as it is).
/// Every code once, in the order of their places.
///
/// ZBar's digits of blurred images are sometimes wrong though their check sum is right (one in ten): what
/// only a changed image yields counts when two preparations agree on it.
std::vector<Barcode> read_barcodes(const cv::Mat& image, bool thorough = true);

}  // namespace loci::perception
