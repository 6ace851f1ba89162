#include "perception/detection/image_region.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>

#include "mapping/base/error.h"
#include "mapping/base/files.h"
#include "mapping/base/math/pose.h"
#include "mapping/image/image_io.h"
#include "perception/detection/detection_values.h"

namespace loci::perception {
namespace {

using nlohmann::json;

constexpr size_t kMaxCorners = 100'000;

[[noreturn]] void refuse(const std::string& where, const std::string& what) {
  throw Error(what, {{}, 0, where});
}

void check_area(double width, double height, const std::string& where) {
  if (width * height > kMaxMaskPixels)
    refuse(where, fmt::format("covers more than {} million pixels", kMaxMaskPixels / 1'000'000));
}

double position(const json& value, const std::string& where) {
  const double number = finite_number(value, where);
  if (std::abs(number) > kMaxImageSide)
    refuse(where, fmt::format("must be pixels of an image of up to {} a side", kMaxImageSide));
  return number;
}

std::vector<double> positions(const json& list, const std::string& where) {
  if (!list.is_array()) refuse(where, fmt::format("must be a list [...], is {}", list.type_name()));
  if (list.size() > 2 * kMaxCorners) refuse(where, fmt::format("has more than {} corners", kMaxCorners));
  std::vector<double> values;
  for (const json& value : list) values.push_back(position(value, where));
  return values;
}

int side(const json& value, const std::string& where) {
  if (!value.is_number_integer() || value.get<int64_t>() < 1 || value.get<int64_t>() > kMaxImageSide)
    refuse(where, fmt::format("must be [height, width], each from 1 to {}", kMaxImageSide));
  return value.get<int>();
}

/// Cuts the mask down to what it holds.
ImageRegion tight(const cv::Mat& mask, const cv::Point& origin, const cv::Size& image,
                  const std::string& where) {
  const cv::Rect box = cv::boundingRect(mask);
  if (box.empty()) refuse(where, "is empty");
  ImageRegion region;
  region.image = image;
  region.mask = mask(box).clone();
  region.origin = origin + box.tl();
  region.box = cv::Rect2d(region.origin.x, region.origin.y, box.width, box.height);
  return region;
}

ImageRegion region_from_file(const std::string& name, const std::string& where,
                             const std::filesystem::path& folder) {
  const std::filesystem::path path = name;
  const bool inside = path.is_relative() && std::ranges::find(path, "..") == path.end();
  if (!inside) refuse(where, "must name an image below the folder of the detections");
  const mapping::ImageHeader header = mapping::read_image_header(folder / path);
  if (header.channels != 1) refuse(where, "must name a grey image");
  check_area(header.width, header.height, where);
  const std::string bytes = read_file(folder / path);
  const cv::Mat image = mapping::decode_image({bytes.begin(), bytes.end()}, (folder / path).string());
  return tight(image > 0, {}, image.size(), where);
}

}  // namespace

ImageRegion region_from_box(const json& box, const std::string& where) {
  const std::vector<double> values = positions(box, where);
  if (values.size() != 4) refuse(where, "must be [x, y, width, height]");
  if (!(values[2] > 0) || !(values[3] > 0)) refuse(where, "must have a width and height above 0");
  ImageRegion region;
  region.box = {values[0], values[1], values[2], values[3]};
  return region;
}

ImageRegion region_from_polygons(const std::vector<std::vector<double>>& polygons, const std::string& where) {
  // In quarters of a pixel, which fillPoly takes as fixed-point numbers of two bits.
  constexpr int kShift = 2;
  std::vector<std::vector<cv::Point>> outlines;
  Eigen::AlignedBox2d extent;
  size_t corners = 0;
  for (const std::vector<double>& polygon : polygons) {
    if (polygon.size() < 6 || polygon.size() % 2 != 0) refuse(where, "has a polygon of fewer than 3 corners");
    if ((corners += polygon.size() / 2) > kMaxCorners)
      refuse(where, fmt::format("has more than {} corners", kMaxCorners));
    for (size_t i = 0; i < polygon.size(); i += 2) extent.extend(Eigen::Vector2d(polygon[i], polygon[i + 1]));
  }
  if (extent.isEmpty()) refuse(where, "has no polygon");
  const cv::Point origin(static_cast<int>(std::floor(extent.min().x())),
                         static_cast<int>(std::floor(extent.min().y())));
  const cv::Size size(static_cast<int>(std::ceil(extent.max().x())) - origin.x + 1,
                      static_cast<int>(std::ceil(extent.max().y())) - origin.y + 1);
  check_area(size.width, size.height, where);
  for (const std::vector<double>& polygon : polygons) {
    std::vector<cv::Point>& outline = outlines.emplace_back();
    const auto fixed = [](double value) {
      return static_cast<int>(std::lround((value - 0.5) * (1 << kShift)));
    };
    for (size_t i = 0; i < polygon.size(); i += 2)
      outline.emplace_back(fixed(polygon[i] - origin.x), fixed(polygon[i + 1] - origin.y));
  }
  cv::Mat mask = cv::Mat::zeros(size, CV_8U);
  for (const std::vector<cv::Point>& outline : outlines)  // Each by itself: where two overlap is object.
    cv::fillPoly(mask, std::vector<std::vector<cv::Point>>{outline}, cv::Scalar(255), cv::LINE_8, kShift);
  return tight(mask, origin, {}, where);
}

std::vector<uint32_t> runs_from_text(const std::string& text, const std::string& where) {
  std::vector<uint32_t> runs;
  size_t at = 0;
  while (at < text.size()) {
    int64_t value = 0;
    for (int shift = 0;; shift += 5) {
      if (at >= text.size() || shift > 30) refuse(where, "has damaged run lengths");
      const int digit = text[at++] - 48;
      if (digit < 0 || digit > 63) refuse(where, "has damaged run lengths");
      value |= static_cast<int64_t>(digit & 0x1f) << shift;
      if ((digit & 0x20) != 0) continue;
      if ((digit & 0x10) != 0) value -= int64_t{1} << (shift + 5);  // the sign
      break;
    }
    // From the third on, a run is the difference to the one before the last.
    if (runs.size() > 2) value += runs[runs.size() - 2];
    if (value < 0 || value > int64_t{kMaxImageSide} * kMaxImageSide) refuse(where, "has damaged run lengths");
    runs.push_back(static_cast<uint32_t>(value));
  }
  return runs;
}

ImageRegion region_from_runs(const std::vector<uint32_t>& runs, const cv::Size& image,
                             const std::string& where) {
  check_area(image.width, image.height, where);
  const uint64_t pixels = static_cast<uint64_t>(image.width) * static_cast<uint64_t>(image.height);
  uint64_t sum = 0, first = pixels, last = 0;
  for (size_t i = 0; i < runs.size(); ++i) {
    if (runs[i] > pixels - sum) refuse(where, "has run lengths beyond its image");
    if (i % 2 == 1 && runs[i] > 0) {
      first = std::min(first, sum);
      last = sum + runs[i];
    }
    sum += runs[i];
  }
  if (sum != pixels) refuse(where, "has run lengths that do not fill its image");
  if (first >= last) refuse(where, "is empty");
  // Only the columns between the first and the last pixel of the object are made.
  const auto rows = static_cast<uint64_t>(image.height);
  const auto left = static_cast<int>(first / rows), right = static_cast<int>((last - 1) / rows);
  cv::Mat columns =
      cv::Mat::zeros(right - left + 1, image.height, CV_8U);  // Transposed: runs are consecutive.
  const uint64_t begin = static_cast<uint64_t>(left) * rows;
  uint64_t at = 0;
  for (size_t i = 0; i < runs.size(); ++i) {
    if (i % 2 == 1 && runs[i] > 0) std::fill_n(columns.data + (at - begin), runs[i], uchar{255});
    at += runs[i];
  }
  return tight(columns.t(), {left, 0}, image, where);
}

ImageRegion region_from_mask(const json& mask, const std::string& where,
                             const std::filesystem::path& folder) {
  if (mask.is_string()) return region_from_file(mask.get<std::string>(), where, folder);
  if (mask.is_array()) {
    std::vector<std::vector<double>> polygons;
    for (const json& polygon : mask) polygons.push_back(positions(polygon, where));
    return region_from_polygons(polygons, where);
  }
  if (!mask.is_object() || !mask.contains("size") || !mask.contains("counts"))
    refuse(where, "must be polygons, the name of an image, or {\"size\": [height, width], \"counts\": ...}");
  const json &size = mask["size"], &counts = mask["counts"];
  if (!size.is_array() || size.size() != 2) refuse(where + ".size", "must be [height, width]");
  const cv::Size image(side(size[1], where + ".size"), side(size[0], where + ".size"));
  if (counts.is_string())
    return region_from_runs(runs_from_text(counts.get<std::string>(), where + ".counts"), image, where);
  if (!counts.is_array()) refuse(where + ".counts", "must be a list of run lengths, or text");
  std::vector<uint32_t> runs;
  for (const json& run : counts) {
    if (!run.is_number_unsigned() || run.get<uint64_t>() > static_cast<uint64_t>(image.area()))
      refuse(where + ".counts", "must be run lengths within the image");
    runs.push_back(run.get<uint32_t>());
  }
  return region_from_runs(runs, image, where);
}

}  // namespace loci::perception
