#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "perception/pipeline/annotator.h"

namespace loci::perception {

/// Share of the masked pixels (BGR) per hue and saturation, hue-major. Hue says nothing about pixels that are
/// nearly grey or nearly black: they count in hue bin 0, saturation bin 0. All zero when the mask is empty.
std::vector<float> hue_saturation_histogram(const cv::Mat& image, const cv::Mat& mask, int hue_bins,
                                            int saturation_bins);

/// The mask without its outermost pixels, where colours mix with the background, unless little would remain.
cv::Mat inner_mask(const cv::Mat& mask);

/// Histogram of an object's colours (Table 8.7).
class ColorHistogramAnnotator : public Annotator {
 public:
  AnnotatorDescriptor descriptor() const override;
  void declare(OptionTable& table) override;
  void process(cas::Cas& cas, Context& context) override;

 private:
  int hue_bins_ = 12;
  int saturation_bins_ = 4;
};

/// Colour in words and numbers.
struct NamedColors {
  std::vector<std::string> names;  ///< those with the largest shares first
  std::vector<double> fractions;   ///< of the pixels
  double mean_hue = 0;             ///< circular, weighted by saturation and value, 0 to 360 degrees
  double mean_saturation = 0;      ///< 0 to 1
  double mean_value = 0;           ///< 0 to 1
};

/// Of the masked pixels of an image (BGR); names below `least` of them are left out. Empty mask: no names.
NamedColors name_colors(const cv::Mat& image, const cv::Mat& mask, double least);

/// Colour names as people use them.
class ColorNameAnnotator : public Annotator {
 public:
  AnnotatorDescriptor descriptor() const override;
  void declare(OptionTable& table) override;
  void process(cas::Cas& cas, Context& context) override;

 private:
  double min_fraction_ = 0.05;
};

}  // namespace loci::perception
