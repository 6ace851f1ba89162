#pragma once

#include "perception/annotators/hypotheses/superpixels.h"
#include "perception/pipeline/annotator.h"

namespace loci::perception {

/// Where the hypotheses of SaliencyDetector are indexed.
inline constexpr std::string_view kSaliencyView = "saliency";

/// Parts the image into patches of about one size in space, in the view "superpixels".
class SuperpixelExtractor : public Annotator {
 public:
  AnnotatorDescriptor descriptor() const override;
  void declare(OptionTable& table) override { options_.declare(table); }
  void process(cas::Cas& cas, Context& context) override;

 private:
  SuperpixelOptions options_;
};

/// Balls around what stands out by its colour: TFLinkSphereROI in the map frame, in the index of the view
/// "saliency", and among the hypotheses of the clusters most of whose points they hold.
class SaliencyDetector : public Annotator {
 public:
  AnnotatorDescriptor descriptor() const override;
  void declare(OptionTable& table) override;
  void process(cas::Cas& cas, Context& context) override;

 private:
  SuperpixelOptions superpixels_;
  double reach_m_ = 0.25, share_ = 0.6, max_radius_m_ = 0.2;
  int most_ = 10;
};

}  // namespace loci::perception
