#include "perception/annotators/description/color_annotators.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <opencv2/imgproc.hpp>

#include "mapping/base/math/math.h"
#include "mapping/image/hsv.h"
#include "perception/conversions/opencv.h"

namespace loci::perception {
namespace {

constexpr float kGreySaturation = 0.12f;
constexpr float kBlackValue = 0.12f;

}  // namespace

cv::Mat inner_mask(const cv::Mat& mask) {
  cv::Mat inner;
  cv::erode(mask, inner, cv::Mat::ones(5, 5, CV_8U), {-1, -1}, 1, cv::BORDER_CONSTANT, cv::Scalar(0));
  return 3 * cv::countNonZero(inner) >= cv::countNonZero(mask) ? inner : mask;
}

std::vector<float> hue_saturation_histogram(const cv::Mat& image, const cv::Mat& mask, int hue_bins,
                                            int saturation_bins) {
  cv::Mat hsv;
  image.convertTo(hsv, CV_32FC3, 1.0 / 255);
  cv::cvtColor(hsv, hsv, cv::COLOR_BGR2HSV);
  std::vector<float> histogram(static_cast<size_t>(hue_bins * saturation_bins), 0.0f);
  int count = 0;
  for (int v = 0; v < image.rows; ++v)
    for (int u = 0; u < image.cols; ++u) {
      if (!mask.at<unsigned char>(v, u)) continue;
      const cv::Vec3f& pixel = hsv.at<cv::Vec3f>(v, u);
      int hue = 0;
      int saturation = 0;
      if (pixel[1] > kGreySaturation && pixel[2] > kBlackValue) {
        hue = std::clamp(static_cast<int>(pixel[0] / 360.0f * static_cast<float>(hue_bins)), 0, hue_bins - 1);
        saturation = std::clamp(static_cast<int>(pixel[1] * static_cast<float>(saturation_bins)), 0,
                                saturation_bins - 1);
      }
      histogram[static_cast<size_t>(hue * saturation_bins + saturation)] += 1;
      ++count;
    }
  for (float& share : histogram) share /= static_cast<float>(std::max(1, count));
  return histogram;
}

AnnotatorDescriptor ColorHistogramAnnotator::descriptor() const {
  return {"ColorHistogram",
          "Computes a hue-saturation histogram of each object.",
          {"Cluster", "StandaloneImageROI"},
          {"ColorHistogram"}};
}

void ColorHistogramAnnotator::declare(OptionTable& table) {
  table.integer("hue_bins", hue_bins_, "", "Bins over 0 to 360 degrees.", 1, 360);
  table.integer("saturation_bins", saturation_bins_, "", "Bins over 0 to 1.", 1, 256);
}

void ColorHistogramAnnotator::process(cas::Cas& cas, Context& /*context*/) {
  for (const types::Cluster& cluster : types::SceneCas(cas).clusters()) {
    const auto roi = cluster.hypotheses.first<types::StandaloneImageROI>();
    if (!roi) continue;
    const cv::Mat mask = inner_mask(types::from<cv::Mat>(roi.mask.get()));
    const auto annotation = types::ColorHistogram::create(cas);
    annotation.source.set(descriptor().name);
    annotation.hue_bins.set(hue_bins_);
    annotation.saturation_bins.set(saturation_bins_);
    annotation.histogram.set(
        hue_saturation_histogram(types::from<cv::Mat>(roi.image.get()), mask, hue_bins_, saturation_bins_));
    cluster.annotations.push_back(annotation);
  }
}

NamedColors name_colors(const cv::Mat& image, const cv::Mat& mask, double least) {
  cv::Mat hsv;
  image.convertTo(hsv, CV_32FC3, 1.0 / 255);
  cv::cvtColor(hsv, hsv, cv::COLOR_BGR2HSV);
  std::map<std::string, int> counts;
  NamedColors colors;
  double cosine = 0;
  double sine = 0;
  int count = 0;
  for (int v = 0; v < image.rows; ++v)
    for (int u = 0; u < image.cols; ++u) {
      if (!mask.at<unsigned char>(v, u)) continue;
      const cv::Vec3f& pixel = hsv.at<cv::Vec3f>(v, u);
      ++counts[mapping::color_name(pixel[0], pixel[1], pixel[2])];
      ++count;
      const double angle = static_cast<double>(pixel[0]) * kPi / 180;
      const auto weight = static_cast<double>(pixel[1] * pixel[2]);
      cosine += weight * std::cos(angle);
      sine += weight * std::sin(angle);
      colors.mean_saturation += static_cast<double>(pixel[1]);
      colors.mean_value += static_cast<double>(pixel[2]);
    }
  if (count == 0) return colors;
  colors.mean_saturation /= count;
  colors.mean_value /= count;
  colors.mean_hue = std::fmod(std::atan2(sine, cosine) * 180 / kPi + 360, 360);
  std::vector<std::pair<int, std::string>> order;
  for (const auto& [name, pixels] : counts) order.emplace_back(-pixels, name);
  std::sort(order.begin(), order.end());
  for (const auto& [pixels, name] : order) {
    const double fraction = -static_cast<double>(pixels) / count;
    if (fraction < least) break;
    colors.names.push_back(name);
    colors.fractions.push_back(fraction);
  }
  return colors;
}

AnnotatorDescriptor ColorNameAnnotator::descriptor() const {
  return {"ColorName",
          "Names the colours of each object and computes their mean.",
          {"Cluster", "StandaloneImageROI"},
          {"ColorAnnotation"}};
}

void ColorNameAnnotator::declare(OptionTable& table) {
  table.number("min_fraction", min_fraction_, "", "Minimum share of the pixels for a colour to be named.", 0,
               1);
}

void ColorNameAnnotator::process(cas::Cas& cas, Context& /*context*/) {
  for (const types::Cluster& cluster : types::SceneCas(cas).clusters()) {
    const auto roi = cluster.hypotheses.first<types::StandaloneImageROI>();
    if (!roi) continue;
    const NamedColors colors = name_colors(types::from<cv::Mat>(roi.image.get()),
                                           inner_mask(types::from<cv::Mat>(roi.mask.get())), min_fraction_);
    if (colors.names.empty()) continue;
    const auto annotation = types::ColorAnnotation::create(cas);
    annotation.source.set(descriptor().name);
    annotation.names.set(colors.names);
    annotation.fractions.set(colors.fractions);
    annotation.mean_hue.set(colors.mean_hue);
    annotation.mean_saturation.set(colors.mean_saturation);
    annotation.mean_value.set(colors.mean_value);
    cluster.annotations.push_back(annotation);
  }
}

}  // namespace loci::perception
