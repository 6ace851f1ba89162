#pragma once

#include "perception/pipeline/annotator.h"

namespace loci::perception {

/// Finds SIFT key points (Lowe, IJCV 2004) on each object, with their positions in space.
class TextureAnnotator : public Annotator {
 public:
  AnnotatorDescriptor descriptor() const override;
  void declare(OptionTable& table) override;
  void process(cas::Cas& cas, Context& context) override;

 private:
  int keypoints_ = 100;
  double pixel_m_ = 0.002;
};

}  // namespace loci::perception
