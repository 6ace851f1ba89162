#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

namespace loci::perception {

/// Largest image whose regions are accepted, pixels a side.
inline constexpr int kMaxImageSide = 20000;
/// Largest image of a mask.
inline constexpr int kMaxMaskPixels = 50'000'000;

/// Part of an image that shows one object: a box, and a mask where one is known. Positions are those of
/// detectors: pixel (column, row) covers [column, column + 1) × [row, row + 1).
struct ImageRegion {
  cv::Size image;    ///< that the region is given in; empty = that of the colour image
  cv::Rect2d box;    ///< around the region
  cv::Mat mask;      ///< CV_8U, 255 = object; empty = all of the box
  cv::Point origin;  ///< of the mask in the image

  /// Whether a position of the image lies in the region.
  bool contains(double x, double y) const {
    // NaN is in no region.
    if (!(x >= box.x && y >= box.y && x < box.x + box.width && y < box.y + box.height)) return false;
    if (mask.empty()) return true;
    const int column = static_cast<int>(x) - origin.x, row = static_cast<int>(y) - origin.y;
    return column >= 0 && row >= 0 && column < mask.cols && row < mask.rows &&
           mask.at<unsigned char>(row, column) != 0;
  }
};

// Regions are read strictly: Error, with the key `where` as its place, for what is not finite, empty,
// negative, too large or does not fit its own size.

/// [x, y, width, height], pixels (COCO).
ImageRegion region_from_box(const nlohmann::json& box, const std::string& where);

/// A mask: run lengths of COCO ({"size": [height, width], "counts": [...] or "compressed"}), polygons
/// ([[x, y, x, y, ...], ...]), or the name of a PNG below `folder` (any pixel above 0).
ImageRegion region_from_mask(const nlohmann::json& mask, const std::string& where,
                             const std::filesystem::path& folder);

/// Polygons, each x, y, x, y, …
ImageRegion region_from_polygons(const std::vector<std::vector<double>>& polygons, const std::string& where);

/// Run lengths of COCO over an image column by column, first of background. Text is the compressed form.
ImageRegion region_from_runs(const std::vector<uint32_t>& runs, const cv::Size& image,
                             const std::string& where);
std::vector<uint32_t> runs_from_text(const std::string& text, const std::string& where);

}  // namespace loci::perception
