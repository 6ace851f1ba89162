#pragma once

#include "perception/classification/primitive_shape.h"
#include "perception/pipeline/annotator.h"

namespace loci::perception {

/// The box, cylinder, cone or sphere that explains a cluster best, with its numbers.
class PrimitiveShapeAnnotator : public Annotator {
 public:
  AnnotatorDescriptor descriptor() const override;
  void declare(OptionTable& table) override;
  void process(cas::Cas& cas, Context& context) override;

 private:
  PrimitiveOptions options_;
  double min_explained_ = 0.6;
};

/// Size in words by the largest extent: what a hand closes around, what one hand holds, what takes two.
class SizeAnnotator : public Annotator {
 public:
  AnnotatorDescriptor descriptor() const override;
  void declare(OptionTable& table) override;
  void process(cas::Cas& cas, Context& context) override;

 private:
  double medium_m_ = 0.1;
  double large_m_ = 0.25;
};

}  // namespace loci::perception
