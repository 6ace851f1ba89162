#include "perception/annotators/segmentation/network_detections.h"

#include "perception/annotators/segmentation/detections2d.h"
#include "perception/conversions/opencv.h"
#include "perception/types/scene_cas.h"

namespace loci::perception {

AnnotatorDescriptor NetworkDetector::descriptor() const {
  AnnotatorDescriptor descriptor{
      kName,
      "Makes clusters with classes of what a network (ONNX) finds in the colour image.",
      {"Scene", "CameraInfo", "view:cloud", "view:color"},
      {"Cluster", "ReferenceClusterPoints", "StandaloneImageROI", "ClassificationAnnotation"},
      {"view:structure", "PlanarSupport", "Cluster"}};
  descriptor.needs_options = true;
  return descriptor;
}

void NetworkDetector::declare(OptionTable& table) {
  table.text("network", path_, "Description of the network (YAML): model, layout, classes, input.");
  table.number("min_score", min_score_, "", "Minimum score of a detection, if above the description's.", 0,
               1);
}

void NetworkDetector::start(Context& /*context*/) {
  if (path_.empty())
    throw Error("NetworkDetector has no network", {},
                "give `network: FILE`, a description of an ONNX model (docs/detections.md)");
  detector_.emplace(path_);
}

void NetworkDetector::process(cas::Cas& cas, Context& /*context*/) {
  std::vector<Detection2D> found =
      detector_->detect(types::view_image(types::SceneCas(cas), types::SceneCas::kColor));
  std::erase_if(found, [&](const Detection2D& detection) { return *detection.score < min_score_; });
  add_detections(cas, found, kName, lifted_);
}

void NetworkDetector::finish(Context& context) {
  warn_of_unlifted(lifted_, path_, context.warnings);
}

}  // namespace loci::perception
