#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "perception/pipeline/annotator.h"

namespace loci::perception {

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
