#pragma once

#include <optional>

#include "perception/annotators/hypotheses/depth_normals.h"
#include "perception/pipeline/annotator.h"

namespace loci::perception {

/// Smoothed depth, cloud and normals of the depth image (§4.2.1).
class NormalEstimator : public Annotator {
 public:
  AnnotatorDescriptor descriptor() const override;
  void declare(OptionTable& table) override { options_.declare(table); }
  void process(cas::Cas& cas, Context& context) override;

 private:
  NormalOptions options_ = NormalOptions::for_objects();
  std::optional<InclinationBias> bias_;  ///< of the camera that was seen last
  mapping::PinholeCamera bias_camera_;
};

}  // namespace loci::perception
