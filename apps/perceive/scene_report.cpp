#include "apps/perceive/scene_report.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

#include "mapping/base/json.h"
#include "mapping/base/time.h"
#include "perception/types/geometry.h"

namespace loci::apps {
namespace {

double rounded(double value) {
  return std::round(value * 1e4) / 1e4;
}

Json vector_json(const perception::types::Vector& vector) {
  const Vector3d v = perception::types::from<Vector3d>(vector);
  return {rounded(v.x()), rounded(v.y()), rounded(v.z())};
}

/// What an annotation says in words and numbers, whatever its type.
Json annotation_json(const perception::types::Annotation& annotation) {
  Json json = {{"type", annotation.type().short_name()}};
  const perception::cas::FeatureStructure& structure = annotation;
  for (const perception::cas::Feature& feature : structure.type().features()) {
    if (!structure.is_set(feature)) continue;
    const perception::cas::Kind kind = feature.range().kind();
    if (kind == perception::cas::Kind::kString) json[feature.name()] = structure.text(feature);
    if (kind == perception::cas::Kind::kBoolean) json[feature.name()] = structure.get<bool>(feature);
    if (perception::cas::is_integer(kind)) json[feature.name()] = structure.get<int64_t>(feature);
    if (perception::cas::is_floating(kind)) json[feature.name()] = rounded(structure.get<double>(feature));
  }
  return json;
}

Json cluster_json(const perception::types::Cluster& cluster, int number) {
  Json json = {{"cluster", number}, {"centroid", vector_json(cluster.centroid.get())}};
  if (cluster.place.is_set()) json["place"] = cluster.place.get();
  if (const auto location = cluster.annotations.first<perception::types::TFLocationAnnotation>())
    json["sentence"] = location.sentence.get();
  if (const auto geometry = cluster.annotations.first<perception::types::GeometryAnnotation>()) {
    json["size"] = vector_json(geometry.size.get());
    json["height"] = rounded(geometry.height.get());
  }
  if (const auto color = cluster.annotations.first<perception::types::ColorAnnotation>()) {
    json["colors"] = color.names.to_vector();
    json["mean_hsv"] = {rounded(color.mean_hue.get()), rounded(color.mean_saturation.get()),
                        rounded(color.mean_value.get())};
  }
  if (const auto points = cluster.hypotheses.first<perception::types::ReferenceClusterPoints>())
    json["points"] = points.indices.get().indices.size();
  json["annotations"] = Json::array();
  for (const perception::types::Annotation& annotation : cluster.annotations)
    json["annotations"].push_back(annotation_json(annotation));
  json["at_image_border"] = cluster.at_image_border.get();
  json["at_support_border"] = cluster.at_support_border.get();
  json["partly_hidden"] = cluster.partly_hidden.get();
  return json;
}

Json support_json(const perception::types::PlanarSupport& support) {
  Json json = Json::object();
  if (support.name.is_set()) json["name"] = support.name.get();
  if (support.support_class.is_set()) json["class"] = support.support_class.get();
  json["height"] = rounded(support.height.get());
  json["inliers"] = support.inliers.get();
  json["covered_fraction"] = rounded(support.covered_fraction.get());
  return json;
}

}  // namespace

Json scene_json(const perception::types::SceneCas& facade) {
  const perception::types::Scene scene = facade.scene();
  Json json = {{"frame", scene.frame_index.get()},
               {"time", format_time(scene.timestamp.get())},
               {"supports", Json::array()},
               {"clusters", Json::array()},
               {"annotations", Json::array()}};
  for (const perception::types::Annotation& annotation : scene.annotations)
    json["annotations"].push_back(annotation_json(annotation));
  for (const perception::types::PlanarSupport& support : facade.supports())
    json["supports"].push_back(support_json(support));
  int number = 0;
  for (const perception::types::Cluster& cluster : facade.clusters())
    json["clusters"].push_back(cluster_json(cluster, ++number));
  return json;
}

std::string scene_text(const perception::types::SceneCas& facade) {
  const Json json = scene_json(facade);
  std::string text =
      fmt::format("frame {}  {}\n", json["frame"].get<int64_t>(), json["time"].get<std::string>());
  for (const Json& support : json["supports"])
    text += fmt::format("  support {} at height {:.3f} m, {:.0f} % of it seen\n",
                        support.value("name", std::string("without a name")), support["height"].get<double>(),
                        100 * support["covered_fraction"].get<double>());
  for (const auto& joint : facade.scene().annotations.filter<perception::types::JointAnnotation>())
    if (joint.moved.get())
      text += fmt::format("  {} stands at {:.2f}\n", joint.joint.get(), joint.position.get());
  for (const auto& obstacle : facade.scene().annotations.filter<perception::types::ObstacleAnnotation>())
    text += fmt::format("  something stands {:.2f} m before {} and hides {:.0f} % of it\n",
                        obstacle.distance.get(), obstacle.joint.get(), 100 * obstacle.share.get());
  for (const Json& cluster : json["clusters"]) {
    text += fmt::format("  {:2} {}", cluster["cluster"].get<int>(),
                        cluster.value("sentence", std::string("somewhere")));
    if (cluster.contains("size"))
      text += fmt::format(", {:.2f} x {:.2f} x {:.2f} m", cluster["size"][0].get<double>(),
                          cluster["size"][1].get<double>(), cluster["size"][2].get<double>());
    if (cluster.contains("colors"))
      text += fmt::format(", {}", fmt::join(cluster["colors"].get<std::vector<std::string>>(), " "));
    if (cluster["at_image_border"].get<bool>()) text += ", cut off by the image";
    if (cluster["partly_hidden"].get<bool>()) text += ", partly hidden";
    text += "\n";
  }
  return text;
}

}  // namespace loci::apps
