#include "perception/annotators/description/shape_annotators.h"

#include <algorithm>
#include <filesystem>
#include <functional>
#include <numeric>

#include "perception/annotators/scene_data.h"
#include "perception/conversions/pcl.h"

namespace loci {
namespace {

/// Descriptors that a cluster has already.
FeatureSet annotated_features(const types::Cluster& cluster) {
  FeatureSet set;
  for (const std::string& name : shape_feature_names())
    for (const auto& annotation : cluster.annotations.filter<types::PclFeatureAnnotation>())
      if (annotation.name.get() == shape_feature_signature(name)) {
        const auto values = annotation.feature.get();
        set[name] = FeatureVector(values.begin(), values.end());
      }
  return set;
}

std::string joined(const Ensemble& model, const std::string& between,
                   const std::function<std::string(const ExpertSpec&)>& text_of) {
  std::string text;
  for (const ExpertSpec& expert : model.experts()) text += (text.empty() ? "" : between) + text_of(expert);
  return text;
}

}  // namespace

SurfacePoints cluster_surface(const types::SceneCas& scene, const types::Cluster& cluster) {
  const cas::Buffer<pcl::PointXYZ> points = types::points_of<pcl::PointXYZ>(scene.cloud());
  const cas::Buffer<pcl::Normal> normals = types::points_of<pcl::Normal>(scene.normals());
  SurfacePoints surface;
  for (const int32_t index : cluster_indices(cluster)) {
    surface.points.emplace_back(points[static_cast<size_t>(index)].getVector3fMap());
    surface.normals.emplace_back(normals[static_cast<size_t>(index)].getNormalVector3fMap());
  }
  return surface;
}

AnnotatorDescriptor PclFeatureAnnotator::descriptor() const {
  return {"PclFeature",
          "Describes each object's shape with descriptors of PCL.",
          {"Cluster", "ReferenceClusterPoints", "view:cloud", "view:normals"},
          {"PclFeatureAnnotation"}};
}

void PclFeatureAnnotator::declare(OptionTable& table) {
  std::string names;
  for (const std::string& name : shape_feature_names()) names += (names.empty() ? "" : ", ") + name;
  table.texts("features", features_, "Descriptors: " + names + ".");
}

void PclFeatureAnnotator::start(Context& /*context*/) {
  for (const std::string& name : features_) shape_feature_signature(name);
}

void PclFeatureAnnotator::process(cas::Cas& cas, Context& /*context*/) {
  const types::SceneCas scene(cas);
  for (const types::Cluster& cluster : scene.clusters()) {
    for (const auto& [name, vector] : feature_set(features_, cluster_surface(scene, cluster))) {
      const auto annotation = types::PclFeatureAnnotation::create(cas);
      annotation.source.set(descriptor().name);
      annotation.name.set(shape_feature_signature(name));
      annotation.feature.set(vector);
      cluster.annotations.push_back(annotation);
    }
  }
}

AnnotatorDescriptor FeatureClassifier::descriptor() const {
  AnnotatorDescriptor descriptor{"FeatureClassifier",
                                 "Classifies objects by descriptors of their shape with a trained model.",
                                 {"Cluster", "ReferenceClusterPoints", "view:cloud", "view:normals"},
                                 {"ClassificationAnnotation"},
                                 {"PclFeatureAnnotation"}};
  descriptor.needs_options = true;
  return descriptor;
}

void FeatureClassifier::declare(OptionTable& table) {
  table.text("model", path_, "Made by `loci-perceive train`.");
  table.text("kind", kind_, "What the classes are: shape, object, ...");
  table.number("least_confidence", least_confidence_, "",
               "Objects whose best class is less probable get none.", 0, 1);
}

void FeatureClassifier::start(Context& /*context*/) {
  if (path_.empty())
    throw Error("FeatureClassifier has no model", {}, "give `model: FILE`, made by `loci-perceive train`");
  model_ = Ensemble::load(path_);
}

void FeatureClassifier::process(cas::Cas& cas, Context& /*context*/) {
  const types::SceneCas scene(cas);
  for (const types::Cluster& cluster : scene.clusters()) {
    FeatureSet features = annotated_features(cluster);
    std::vector<std::string> missing = model_->features();
    std::erase_if(missing, [&](const std::string& name) { return features.contains(name); });
    if (!missing.empty()) features.merge(feature_set(missing, cluster_surface(scene, cluster)));
    const std::vector<std::string> needed = model_->features();
    if (!std::all_of(needed.begin(), needed.end(), [&](const auto& name) { return features.contains(name); }))
      continue;  // Too few points for a descriptor.
    const Classification result = model_->classify(features);
    if (result.probabilities[result.best] < least_confidence_) continue;
    const auto annotation = types::ClassificationAnnotation::create(cas);
    annotation.source.set(descriptor().name);
    annotation.confidence.set(result.probabilities[result.best]);
    annotation.kind.set(kind_);
    annotation.label.set(model_->classes()[result.best]);
    annotation.feature.set(joined(*model_, "+", [](const ExpertSpec& e) { return e.feature; }));
    annotation.classifier.set(joined(*model_, "+", [](const ExpertSpec& e) { return e.options.method; }));
    annotation.model.set(std::filesystem::path(path_).stem().string());
    std::vector<size_t> order(result.probabilities.size());
    std::iota(order.begin(), order.end(), size_t{0});
    std::stable_sort(order.begin(), order.end(),
                     [&](size_t a, size_t b) { return result.probabilities[a] > result.probabilities[b]; });
    for (const size_t c : order) {
      const auto confidence = types::ClassConfidence::create(cas);
      confidence.name.set(model_->classes()[c]);
      confidence.confidence.set(result.probabilities[c]);
      confidence.accuracy.set(model_->accuracies()[c]);
      annotation.confidences.push_back(confidence);
    }
    cluster.annotations.push_back(annotation);
  }
}

}  // namespace loci
