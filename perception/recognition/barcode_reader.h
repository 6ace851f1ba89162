#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

namespace loci::perception {

struct Barcode {
  /// As people write them: "EAN-13", "EAN-8", "UPC-A", "UPC-E", "QR", "Data Matrix", "PDF417", "Aztec",
  /// "Code 128", …
  std::string symbology;
  std::string code;  ///< what it says
  cv::Rect region;   ///< pixels of the image
  /// How the image had to be changed for it, in words; empty = not at all.
  std::string preparation;
};

/// Reads barcodes and codes of areas (QR, Data Matrix, PDF417, Aztec) with ZBar and ZXing, from an image
/// (CV_8UC1 or CV_8UC3 BGR). What neither reads in the image as it is, is tried sharpened, with even light,
/// as black and white, at other scales and turned; the first preparation that yields a code ends the search
/// (`thorough` = false: only the image as it is). Every code once, in the order of their places.
///
/// Digits of blurred bars are sometimes wrong though their check sum is right (with ZBar one in ten): bars
/// that only a changed image yields count when two preparations or both readers agree on them.
std::vector<Barcode> read_barcodes(const cv::Mat& image, bool thorough = true);

/// The twelve digits of UPC-A, which EAN-13 writes with a leading zero; other codes as they are.
std::string without_leading_zero(const std::string& code);

}  // namespace loci::perception
