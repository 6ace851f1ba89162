#pragma once

#include "perception/pipeline/annotator.h"

namespace loci::perception {

/// Makes regions of the image comparable (§3.2.2): a perceptual hash, and what that does not tell, colours.
class PerceptualHashAnnotator : public Annotator {
 public:
  AnnotatorDescriptor descriptor() const override;
  void process(cas::Cas& cas, Context& context) override;
};

}  // namespace loci::perception
