#pragma once

#include <optional>

#include "perception/classification/ensemble.h"
#include "perception/classification/household_model.h"
#include "perception/classification/primitive_shape.h"
#include "perception/pipeline/annotator.h"
#include "perception/types/scene_cas.h"

namespace loci::perception {

/// What a cluster shows of its surface: points with normals in the camera frame, with the colours of the
/// image where there is one.
SurfacePoints cluster_surface(const types::SceneCas& scene, const types::Cluster& cluster);

/// What it shows: its surface where the scene has a cloud, its image where it has one.
ObjectView cluster_view(const types::SceneCas& scene, const types::Cluster& cluster);

/// What a cluster's support is in the frame of these points; without one the map's horizontal through its
/// lowest point.
Ground cluster_ground(const types::SceneCas& scene, const types::Cluster& cluster);

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
  std::vector<std::string> keypoints_;
};

/// Descriptors of each cluster's image: of all of it, or of its key points.
class ImageFeatureAnnotator : public Annotator {
 public:
  AnnotatorDescriptor descriptor() const override;
  void declare(OptionTable& table) override;
  void start(Context& context) override;
  void process(cas::Cas& cas, Context& context) override;

 private:
  std::vector<std::string> features_ = {"HOG", "SIFT"};
};

/// Classifies clusters by their descriptors with a trained model (§5.2). Descriptors that nobody has
/// annotated are computed, but not annotated.
class FeatureClassifier : public Annotator {
 public:
  /// By images alone: no cloud is needed.
  explicit FeatureClassifier(bool images_only = false) : images_only_(images_only) {}
  AnnotatorDescriptor descriptor() const override;
  void declare(OptionTable& table) override;
  void start(Context& context) override;
  void process(cas::Cas& cas, Context& context) override;

 private:
  bool images_only_;
  std::string path_;
  std::string kind_ = "shape";
  double min_confidence_ = 0;
  std::optional<Ensemble> model_;
};

/// Names household objects by shape, size and colour: cup, plate, bottle, box, ... What is not sure enough
/// gets the name of its group, or none.
class HouseholdClassifier : public Annotator {
 public:
  AnnotatorDescriptor descriptor() const override;
  void declare(OptionTable& table) override;
  void start(Context& context) override;
  void process(cas::Cas& cas, Context& context) override;

 private:
  std::string path_;
  std::optional<HouseholdModel> own_;
};

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
