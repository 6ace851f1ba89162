#pragma once

#include <optional>

#include "perception/pipeline/annotator.h"
#include "perception/recognition/template_detector.h"

namespace loci::perception {

/// Finds things in the whole image as they were shown before (LINEMOD): what a cluster shows is annotated,
/// elsewhere a match is a hypothesis of its own.
class TemplateAnnotator : public Annotator {
 public:
  AnnotatorDescriptor descriptor() const override;
  void declare(OptionTable& table) override;
  void start(Context& context) override;
  void process(cas::Cas& cas, Context& context) override;

 private:
  std::string path_;
  std::string kind_ = "object";
  bool hypotheses_ = false;
  TemplateOptions options_;
  std::optional<TemplateDetector> detector_;
};

}  // namespace loci::perception
