#include "perception/annotators/hypotheses/flat_search.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "mapping/base/quantile.h"
#include "perception/annotators/hypotheses/flat_colors.h"

namespace loci::perception {

double pixel_noise(const cv::Mat& heights) {
  constexpr float kStep = 0.02f;  // What differs by more is an edge.
  double sum = 0;
  int count = 0;
  for (int v = 0; v < heights.rows; v += 2) {
    const auto* height = heights.ptr<float>(v);
    for (int u = 1; u < heights.cols; u += 2) {
      const float d = height[u] - height[u - 1];
      if (!(std::abs(d) < kStep)) continue;
      sum += static_cast<double>(d * d);
      ++count;
    }
  }
  return count == 0 ? 0 : std::sqrt(sum / count / 2);
}

FlatSearch::FlatSearch(const cv::Mat& depth, const cv::Mat& color, const mapping::RgbdCamera& camera,
                       const FlatSurface& surface, const FlatOptions& options)
    : depth_(depth),
      camera_(camera),
      surface_(surface),
      options_(options),
      registration_(camera, surface.normal, surface.offset),
      bin_of_color_(color_bins(color, options.bins)),
      open_(surface.inside.clone()) {}

/// What the plane's normal and depth make of one pixel of the colour image, m².
double FlatSearch::pixel_area(const cv::Point& pixel) const {
  const Vector3d ray = camera_.depth_from_color.linear() * camera_.color.unproject(pixel.x, pixel.y, 1);
  const double slope = std::abs(surface_.normal.dot(ray));
  const Vector3d& eye = camera_.depth_from_color.translation();
  const double z = std::abs(surface_.offset - surface_.normal.dot(eye)) / std::max(1e-6, slope);
  return z * z / (camera_.color.fx * camera_.color.fy) / std::max(0.05, slope);
}

/// Where colour may carry an object on.
cv::Mat FlatSearch::near(const cv::Mat& seeds) const {
  const cv::Moments moments = cv::moments(seeds, true);
  const cv::Point centre(static_cast<int>(moments.m10 / moments.m00),
                         static_cast<int>(moments.m01 / moments.m00));
  const int width = 2 * static_cast<int>(options_.reach_m / std::sqrt(pixel_area(centre))) + 1;
  cv::Mat reached;
  cv::dilate(seeds, reached, cv::getStructuringElement(cv::MORPH_RECT, {width, width}));
  return reached;
}

void FlatSearch::leave_out(const std::vector<FlatObject>& objects) {
  if (objects.empty()) return;
  cv::Mat taken = cv::Mat::zeros(open_.size(), CV_8U);
  for (const FlatObject& object : objects)
    for (const int pixel : object.pixels) taken.ptr<unsigned char>()[pixel] = 255;
  cv::dilate(taken, taken, cv::Mat::ones(7, 7, CV_8U));
  open_.setTo(0, taken);
}

std::vector<FlatObject> FlatSearch::find(const cv::Mat& over_depth, double object_m) const {
  const cv::Mat heights = registration_.seen_by_color(over_depth, std::numeric_limits<double>::quiet_NaN());
  const cv::Mat inside = registration_.seen_by_color(open_, 0);
  const cv::Mat low = heights < options_.table_m;
  const cv::Mat high = heights > object_m;
  const cv::Mat too_high = heights > options_.max_height_m;
  const FlatSeeds seeds = {low & inside, high & inside & ~too_high};
  if (cv::countNonZero(seeds.object) < 20) return {};
  const double noise = std::max(0.0015, 2 * std::min(options_.noise_m, pixel_noise(over_depth)));
  cv::Mat odds = color_log_odds(bin_of_color_, seeds, options_.bins) +
                 height_log_odds(heights, options_.table_m, object_m, noise);
  cv::boxFilter(odds, odds, CV_32F, {3, 3});
  cv::Mat mask = (odds > 0) & near(seeds.object) & inside & ~too_high;
  const cv::Mat round = cv::getStructuringElement(cv::MORPH_ELLIPSE, {5, 5});
  cv::morphologyEx(mask, mask, cv::MORPH_OPEN, round);
  cv::morphologyEx(mask, mask, cv::MORPH_CLOSE, round);

  cv::Mat labels;
  cv::Mat boxes;
  cv::Mat centres;
  const int count = cv::connectedComponentsWithStats(mask, labels, boxes, centres, 8);
  std::vector<FlatObject> objects;
  cv::Mat object_of(labels.size(), CV_32S, cv::Scalar(-1));
  for (int label = 1; label < count; ++label) {
    const cv::Rect box(boxes.at<int>(label, cv::CC_STAT_LEFT), boxes.at<int>(label, cv::CC_STAT_TOP),
                       boxes.at<int>(label, cv::CC_STAT_WIDTH), boxes.at<int>(label, cv::CC_STAT_HEIGHT));
    const int pixels = boxes.at<int>(label, cv::CC_STAT_AREA);
    const double scale = pixel_area((box.tl() + box.br()) / 2);
    if (pixels * scale < options_.min_area_m2) continue;
    if (std::max(box.width, box.height) * std::sqrt(scale) > options_.max_extent_m) continue;
    // Colour may carry an object on, but most of it has to be there.
    const cv::Mat own = labels(box) == label;
    if (4 * cv::countNonZero(own & seeds.object(box)) < pixels) continue;
    object_of(box).setTo(static_cast<double>(objects.size()), own);
    objects.push_back({box, own, {}, 0});
  }
  assign_depth_pixels(over_depth, object_of, objects);
  return objects;
}

/// The objects' depth pixels: those that fall into an object's mask in the colour image.
void FlatSearch::assign_depth_pixels(const cv::Mat& heights, const cv::Mat& object_of_color,
                                     std::vector<FlatObject>& objects) const {
  if (objects.empty()) return;
  const Isometry3d color_from_depth = camera_.depth_from_color.inverse();
  std::vector<std::vector<float>> over(objects.size());
  for (int v = 0; v < depth_.rows; ++v)
    for (int u = 0; u < depth_.cols; ++u) {
      if (std::isnan(heights.at<float>(v, u))) continue;
      const Vector3d p =
          color_from_depth * camera_.depth.unproject(u, v, static_cast<double>(depth_.at<float>(v, u)));
      if (p.z() <= 0) continue;
      const Vector2d at = camera_.color.project(p);
      if (!camera_.color.contains(at)) continue;
      const int object =
          object_of_color.at<int>(static_cast<int>(at.y() + 0.5), static_cast<int>(at.x() + 0.5));
      if (object < 0) continue;
      objects[static_cast<size_t>(object)].pixels.push_back(v * depth_.cols + u);
      over[static_cast<size_t>(object)].push_back(heights.at<float>(v, u));
    }
  for (size_t i = 0; i < objects.size(); ++i)
    if (!over[i].empty()) objects[i].height = static_cast<double>(median(over[i]));
}

}  // namespace loci::perception
