#pragma once

#include <optional>

#include "perception/classification/ensemble.h"
#include "perception/pipeline/annotator.h"
#include "perception/types/scene_cas.h"

namespace loci {

/// What a cluster shows of its surface: points with normals in the camera frame.
SurfacePoints cluster_surface(const types::SceneCas& scene, const types::Cluster& cluster);

/// Any of PCL's descriptors of shape for each cluster, through delegates (the
/// GenericFeatureFromNormalsEstimator of §5.1).
class PclFeatureAnnotator : public Annotator {
 public:
  AnnotatorDescriptor descriptor() const override;
  void declare(OptionTable& table) override;
  void start(Context& context) override;
  void process(cas::Cas& cas, Context& context) override;

 private:
  std::vector<std::string> features_ = {"VFH"};
};

/// Classifies clusters by their descriptors with a trained model (§5.2). Descriptors that PclFeature has not
/// made are computed, but not annotated.
class FeatureClassifier : public Annotator {
 public:
  AnnotatorDescriptor descriptor() const override;
  void declare(OptionTable& table) override;
  void start(Context& context) override;
  void process(cas::Cas& cas, Context& context) override;

 private:
  std::string path_;
  std::string kind_ = "shape";
  double least_confidence_ = 0;
  std::optional<Ensemble> model_;
};

}  // namespace loci
