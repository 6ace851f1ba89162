#include "perception/annotators/description/primitive_annotator.h"

#include <cmath>

#include "perception/annotators/description/shape_annotators.h"
#include "perception/annotators/scene_data.h"

namespace loci::perception {

AnnotatorDescriptor PrimitiveShapeAnnotator::descriptor() const {
  return {"PrimitiveShape",
          "Fits a box, cylinder, cone or sphere to each object and gives its numbers.",
          {"Scene", "Cluster", "ReferenceClusterPoints", "PlanarSupport", "view:cloud", "view:normals"},
          {"PrimitiveShapeAnnotation"}};
}

void PrimitiveShapeAnnotator::declare(OptionTable& table) {
  options_.declare(table);
  table.number("min_explained", min_explained_, "", "Objects of which less lies on the best shape get none.",
               0, 1);
}

void PrimitiveShapeAnnotator::process(cas::Cas& cas, Context& /*context*/) {
  const types::SceneCas scene(cas);
  for (const types::Cluster& cluster : scene.clusters()) {
    const std::optional<PrimitiveShape> shape =
        fit_primitive(cluster_surface(scene, cluster), cluster_ground(scene, cluster), options_);
    if (!shape || shape->explained < min_explained_) continue;
    const auto annotation = types::PrimitiveShapeAnnotation::create(cas);
    annotation.source.set(descriptor().name);
    annotation.confidence.set(shape->probability * shape->explained);
    annotation.kind.set(name_of(shape->kind));
    annotation.map_from_shape.set(
        types::to(cas, Isometry3d(map_from_camera(scene.scene()) * shape->frame_from_shape)));
    annotation.size.set(types::to(cas, shape->size));
    const bool box = shape->kind == PrimitiveShape::Kind::box,
               sphere = shape->kind == PrimitiveShape::Kind::sphere;
    if (!box) annotation.radius.set(shape->radius());
    if (!sphere) annotation.height.set(shape->size.z());
    if (!box && !sphere) {
      annotation.radius_low.set(shape->radius_low);
      annotation.radius_high.set(shape->radius_high);
    }
    annotation.explained.set(shape->explained);
    annotation.error.set(shape->error);
    cluster.annotations.push_back(annotation);
  }
}

AnnotatorDescriptor SizeAnnotator::descriptor() const {
  return {"Size",
          "Says in a word how large each object is.",
          {"Cluster", "GeometryAnnotation"},
          {"SizeAnnotation"}};
}

void SizeAnnotator::declare(OptionTable& table) {
  table.number("medium_m", medium_m_, "m", "From this largest extent on a thing is medium.", 0.01, 10);
  table.number("large_m", large_m_, "m", "From this on it is large.", 0.01, 10);
}

void SizeAnnotator::process(cas::Cas& cas, Context& /*context*/) {
  const types::SceneCas scene(cas);
  for (const types::Cluster& cluster : scene.clusters()) {
    const auto geometry = cluster.annotations.first<types::GeometryAnnotation>();
    if (!geometry) continue;
    const double extent = types::from<Vector3d>(geometry.size.get()).maxCoeff();
    // An extent is good to about a centimetre (half of it: two ends): so sure is the word near a limit.
    constexpr double kScatter = 0.01;
    const double off = std::min(std::abs(extent - medium_m_), std::abs(extent - large_m_));
    const auto annotation = types::SizeAnnotation::create(cas);
    annotation.source.set(descriptor().name);
    annotation.confidence.set(0.5 * (1 + std::erf(off / (kScatter * std::sqrt(2.0)))));
    annotation.extent.set(extent);
    annotation.size.set(extent < medium_m_ ? "small" : extent < large_m_ ? "medium" : "large");
    cluster.annotations.push_back(annotation);
  }
}

}  // namespace loci::perception
