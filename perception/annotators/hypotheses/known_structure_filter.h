#pragma once

#include "perception/annotators/hypotheses/known_structure.h"
#include "perception/pipeline/annotator.h"

namespace loci {

/// Takes what the map explains out of the cloud and names the regions of interest (URDFRegionFilter,
/// §4.2.2). Uses the KnownMap among the resources; without one it removes nothing.
class KnownStructureFilter : public Annotator {
 public:
  AnnotatorDescriptor descriptor() const override;
  void declare(OptionTable& table) override { options_.declare(table); }
  void start(Context& context) override;
  void process(cas::Cas& cas, Context& context) override;

 private:
  KnownStructureOptions options_;
  KnownMap* map_ = nullptr;
  std::vector<SupportSurface> surfaces_;
};

}  // namespace loci
