#pragma once

#include "perception/annotators/hypotheses/transparent_candidates.h"
#include "perception/pipeline/annotator.h"

namespace loci::perception {

/// Holes in depth as candidates for glasses: clusters without points, with a box, a region of the colour
/// image, and a classification of kind "material" that says "transparent" and how much speaks for it.
class TransparentExtractor : public Annotator {
 public:
  AnnotatorDescriptor descriptor() const override;
  void declare(OptionTable& table) override;
  void process(cas::Cas& cas, Context& context) override;

 private:
  TransparentOptions options_;
};

}  // namespace loci::perception
