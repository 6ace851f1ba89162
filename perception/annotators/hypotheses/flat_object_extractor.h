#pragma once

#include <filesystem>
#include <string>

#include "perception/annotators/hypotheses/flat_objects.h"
#include "perception/pipeline/annotator.h"

namespace loci::perception {

/// Flat things on the supports that were found before it, one cluster each, with a mask in the colour image
/// (§4.3): what is too low to be told from the support by its height alone. What already is a cluster is left
/// alone.
class FlatObjectExtractor : public Annotator {
 public:
  AnnotatorDescriptor descriptor() const override;
  void declare(OptionTable& table) override;
  /// Error when the calibration is asked for and cannot be read.
  void start(Context& context) override;
  void process(cas::Cas& cas, Context& context) override;

 private:
  FlatOptions options_;
  std::string calibration_;
  cv::Mat empty_depth_;
};

/// SurfaceCalibration::mean() as a 16-bit PNG in tenths of a millimetre, 0 = none.
void write_surface(const std::filesystem::path& path, const cv::Mat& empty_depth);
cv::Mat read_surface(const std::filesystem::path& path);

}  // namespace loci::perception
