#include "perception/annotators/description/network_embedding.h"

#include "perception/conversions/opencv.h"
#include "perception/types/scene_cas.h"

namespace loci::perception {

AnnotatorDescriptor NetworkEmbedding::descriptor() const {
  AnnotatorDescriptor descriptor{"NetworkEmbedding",
                                 "Computes a vector of each object's image with a network (ONNX).",
                                 {"Cluster", "StandaloneImageROI"},
                                 {"ImageFeatureAnnotation"}};
  descriptor.needs_options = true;
  return descriptor;
}

void NetworkEmbedding::declare(OptionTable& table) {
  table.text("network", path_, "Description of the network (YAML): model, name, output, input.");
}

void NetworkEmbedding::start(Context& /*context*/) {
  if (path_.empty())
    throw Error("NetworkEmbedding has no network", {},
                "give `network: FILE`, a description of an ONNX model (docs/detections.md)");
  encoder_.emplace(path_);
}

void NetworkEmbedding::process(cas::Cas& cas, Context& /*context*/) {
  std::vector<types::Cluster> clusters;
  std::vector<cv::Mat> images;
  for (const types::Cluster& cluster : types::SceneCas(cas).clusters()) {
    const auto roi = cluster.hypotheses.first<types::StandaloneImageROI>();
    if (!roi) continue;
    const cv::Mat image = types::from<cv::Mat>(roi.image.get());
    if (image.empty() || image.type() != CV_8UC3) continue;
    clusters.push_back(cluster);
    images.push_back(image);
  }
  const std::vector<std::vector<float>> vectors = encoder_->encode(images);
  for (size_t i = 0; i < vectors.size(); ++i) {
    if (vectors[i].empty()) continue;
    const auto annotation = types::ImageFeatureAnnotation::create(cas);
    annotation.source.set(descriptor().name);
    annotation.name.set(encoder_->name());
    annotation.feature.set(vectors[i]);
    clusters[i].annotations.push_back(annotation);
  }
}

}  // namespace loci::perception
