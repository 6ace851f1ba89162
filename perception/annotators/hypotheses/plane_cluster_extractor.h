#pragma once

#include "perception/annotators/hypotheses/object_clusters.h"
#include "perception/pipeline/annotator.h"

namespace loci::perception {

/// Supporting planes and the objects that stand on them (§4.3). With regions of interest (from
/// KnownStructureFilter) a support is the region's surface, refined on what the frame shows; without, all
/// horizontal planes of the frame are supports, as yet without names.
class PlaneClusterExtractor : public Annotator {
 public:
  AnnotatorDescriptor descriptor() const override;
  void declare(OptionTable& table) override;
  void process(cas::Cas& cas, Context& context) override;

 private:
  SupportOptions support_options_;
  ClusterOptions cluster_options_;
};

}  // namespace loci::perception
