#include "perception/annotators/description/template_annotator.h"

#include <filesystem>

#include "perception/annotators/hypotheses/cluster_parts.h"
#include "perception/conversions/opencv.h"
#include "perception/types/scene_cas.h"

namespace loci::perception {
namespace {

/// The cluster whose image overlaps a region most, by at least `least` of both together; null = none.
types::Cluster cluster_at(const types::SceneCas& scene, const cv::Rect& region, double least) {
  types::Cluster best;
  for (const types::Cluster& cluster : scene.clusters()) {
    const auto roi = cluster.hypotheses.first<types::StandaloneImageROI>();
    if (!roi) continue;
    const auto box = types::from<cv::Rect>(roi.roi.get());
    const double both = (box & region).area();
    const double overlap = both / std::max(1.0, box.area() + region.area() - both);
    if (overlap < least) continue;
    least = overlap;
    best = cluster;
  }
  return best;
}

types::Cluster new_cluster(const types::SceneCas& scene, const cv::Rect& region, const std::string& source) {
  const auto cluster = types::Cluster::create(scene.cas());
  add_image(cluster, source, {region, cv::Mat(region.size(), CV_8U, cv::Scalar(255))}, scene);
  scene.add_cluster(cluster);
  return cluster;
}

}  // namespace

AnnotatorDescriptor TemplateAnnotator::descriptor() const {
  AnnotatorDescriptor descriptor{"TemplateDetector",
                                 "Finds known views of things in the whole image (LINEMOD).",
                                 {"Scene", "view:color", "view:depth"},
                                 {"ClassificationAnnotation", "Cluster", "StandaloneImageROI"},
                                 {"Cluster", "StandaloneImageROI"}};
  descriptor.needs_options = true;
  return descriptor;
}

void TemplateAnnotator::declare(OptionTable& table) {
  table.text("templates", path_, "Made by `loci-perceive train --templates`.");
  table.text("kind", kind_, "What the names are: object, shape, ...");
  table.flag("hypotheses", hypotheses_, "What no cluster shows becomes one, without points.");
  options_.declare(table);
}

void TemplateAnnotator::start(Context& /*context*/) {
  if (path_.empty())
    throw Error("TemplateDetector has no templates", {},
                "give `templates: FILE`, made by `loci-perceive train --templates`");
  detector_ = TemplateDetector::load(path_);
}

void TemplateAnnotator::process(cas::Cas& cas, Context& context) {
  constexpr double kSameThing = 0.3;
  const types::SceneCas scene(cas);
  const cv::Mat color = types::view_image(scene, types::SceneCas::kColor),
                depth = types::view_image(scene, types::SceneCas::kDepth);
  if (color.size() != depth.size()) {
    context.warnings.add("TemplateDetector: colour and depth are not of the same size");
    return;
  }
  for (const TemplateMatch& match : detector_->detect(color, depth, options_)) {
    types::Cluster cluster = cluster_at(scene, match.region, kSameThing);
    if (!cluster && !hypotheses_) continue;
    if (!cluster) cluster = new_cluster(scene, match.region, descriptor().name);
    const auto annotation = types::ClassificationAnnotation::create(cas);
    annotation.source.set(descriptor().name);
    annotation.confidence.set(match.similarity);
    annotation.kind.set(kind_);
    annotation.label.set(match.name);
    annotation.feature.set("gradients+normals");
    annotation.classifier.set("LINEMOD");
    annotation.model.set(std::filesystem::path(path_).stem().string());
    cluster.annotations.push_back(annotation);
  }
}

}  // namespace loci::perception
