#include "perception/types/scene_json.h"

#include <algorithm>
#include <cmath>

#include "mapping/base/text/json.h"
#include "mapping/base/time.h"
#include "perception/cas/json.h"
#include "perception/types/geometry.h"

namespace loci::perception::types {
namespace {

double rounded(double value) {
  return std::round(value * 1e4) / 1e4;
}

Json vector_json(const Vector& vector) {
  const Vector3d v = from<Vector3d>(vector);
  return {rounded(v.x()), rounded(v.y()), rounded(v.z())};
}

bool is_readable(const cas::FeatureStructure& array) {
  return array && !array.is_deleted() && array.type().component_kind() != cas::Kind::kStructure;
}

/// Numbers that are not finite are null, as where they stand alone.
Json values_json(const cas::FeatureStructure& array) {
  Json values = cas::elements_to_json(array);
  if (cas::is_floating(array.type().component_kind()))
    for (Json& value : values)
      if (!value.is_number()) value = nullptr;
  return values;
}

Json cluster_json(const Cluster& cluster, int number) {
  Json json = {{"cluster", number}, {"centroid", vector_json(cluster.centroid.get())}};
  if (cluster.place.is_set()) json["place"] = cluster.place.get();
  if (const auto location = cluster.annotations.first<TFLocationAnnotation>())
    json["sentence"] = location.sentence.get();
  if (const auto geometry = cluster.annotations.first<GeometryAnnotation>()) {
    json["size"] = vector_json(geometry.size.get());
    json["height"] = rounded(geometry.height.get());
  }
  if (const auto color = cluster.annotations.first<ColorAnnotation>()) {
    json["colors"] = color.names.to_vector();
    json["mean_hsv"] = {rounded(color.mean_hue.get()), rounded(color.mean_saturation.get()),
                        rounded(color.mean_value.get())};
  }
  if (const auto points = cluster.hypotheses.first<ReferenceClusterPoints>())
    json["points"] = points.indices.get().indices.size();
  json["annotations"] = Json::array();
  for (const Annotation& annotation : cluster.annotations) json["annotations"].push_back(to_json(annotation));
  json["at_image_border"] = cluster.at_image_border.get();
  json["at_support_border"] = cluster.at_support_border.get();
  json["partly_hidden"] = cluster.partly_hidden.get();
  return json;
}

Json support_json(const PlanarSupport& support) {
  Json json = Json::object();
  if (support.name.is_set()) json["name"] = support.name.get();
  if (support.support_class.is_set()) json["class"] = support.support_class.get();
  json["height"] = rounded(support.height.get());
  json["inliers"] = support.inliers.get();
  json["covered_fraction"] = rounded(support.covered_fraction.get());
  return json;
}

/// Clusters by their numbers, supports by their names.
Json related_json(const SceneCas& scene, const Identifiable& related) {
  if (const auto number = number_of(scene, related)) return *number;
  if (const auto support = try_as<PlanarSupport>(related)) return support->name.get();
  return nullptr;
}

Json relation_json(const SceneCas& scene, const Relation& relation) {
  return {{"name", relation.name.get()},
          {"object1", related_json(scene, relation.object1.get())},
          {"object2", related_json(scene, relation.object2.get())},
          {"probability", rounded(relation.probability.get())}};
}

}  // namespace

std::optional<size_t> number_of(const SceneCas& scene, const Identifiable& cluster) {
  const std::vector<Cluster> clusters = scene.scene().clusters.to_vector();
  const auto found = std::ranges::find_if(clusters, [&](const Cluster& each) { return each == cluster; });
  if (found == clusters.end()) return std::nullopt;
  return static_cast<size_t>(found - clusters.begin()) + 1;
}

Json to_json(const Annotation& annotation, Arrays arrays) {
  Json json = {{"type", annotation.type().short_name()}};
  const cas::FeatureStructure& structure = annotation;
  for (const cas::Feature& feature : structure.type().features()) {
    if (!structure.is_set(feature)) continue;
    const cas::Kind kind = feature.range().kind();
    if (kind == cas::Kind::kString) json[feature.name()] = structure.text(feature);
    if (kind == cas::Kind::kBoolean) json[feature.name()] = structure.get<bool>(feature);
    if (cas::is_integer(kind)) json[feature.name()] = structure.get<int64_t>(feature);
    if (cas::is_floating(kind)) json[feature.name()] = rounded(structure.get<double>(feature));
    if (arrays == Arrays::written && kind == cas::Kind::kArray)
      if (const auto array = structure.get<cas::FeatureStructure>(feature); is_readable(array))
        json[feature.name()] = values_json(array);
  }
  return json;
}

Json to_json(const SceneCas& facade) {
  const Scene scene = facade.scene();
  Json json = {{"frame", scene.frame_index.get()}, {"time", format_time(scene.timestamp.get())},
               {"supports", Json::array()},        {"clusters", Json::array()},
               {"relations", Json::array()},       {"annotations", Json::array()}};
  for (const Annotation& annotation : scene.annotations) json["annotations"].push_back(to_json(annotation));
  for (const PlanarSupport& support : facade.supports()) json["supports"].push_back(support_json(support));
  int number = 0;
  for (const Cluster& cluster : facade.clusters())
    json["clusters"].push_back(cluster_json(cluster, ++number));
  for (const Relation& relation : scene.relations)
    json["relations"].push_back(relation_json(facade, relation));
  return json;
}

}  // namespace loci::perception::types
