#include "perception/annotators/description/location_annotator.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "perception/annotators/scene_data.h"

namespace loci::perception {

std::string edge_phrase(const Vector2d& position, const std::vector<Vector2d>& outline) {
  if (outline.size() < 3) return {};
  Eigen::AlignedBox2d extent;
  for (const Vector2d& corner : outline) extent.extend(corner);
  const std::array<std::pair<double, const char*>, 4> edges = {{{position.x() - extent.min().x(), "left"},
                                                                {extent.max().x() - position.x(), "right"},
                                                                {position.y() - extent.min().y(), "front"},
                                                                {extent.max().y() - position.y(), "back"}}};
  const auto nearest = std::min_element(edges.begin(), edges.end());
  return fmt::format("{:.2f} m from its {} edge", std::max(0.0, nearest->first), nearest->second);
}

std::string place_phrase(const std::string& place, const std::string& support_class) {
  if (place.empty()) return "on a surface";
  const std::string bottom = "_bottom";
  if (support_class == "drawer_bottom" || (place.starts_with("drawer") && place.ends_with(bottom)))
    return "in " + (place.ends_with(bottom) ? place.substr(0, place.size() - bottom.size()) : place);
  return "on " + place;
}

AnnotatorDescriptor LocationAnnotator::descriptor() const {
  return {"LocationAnnotator",
          "Says on or in which place each object is, and how far from its edge.",
          {"Scene", "Cluster", "PlanarSupport"},
          {"TFLocationAnnotation"},
          {},
          {"Cluster.place"}};
}

void LocationAnnotator::process(cas::Cas& cas, Context& /*context*/) {
  const types::SceneCas facade(cas);
  const std::vector<types::Cluster> all = facade.scene().clusters.to_vector();
  for (const types::Cluster& cluster : facade.clusters()) {
    const types::PlanarSupport support = cluster.support.get();
    if (!support) continue;
    const Isometry3d support_from_map = types::from<Isometry3d>(support.map_from_support.get()).inverse();
    Isometry3d place_from_cluster = Isometry3d::Identity();
    place_from_cluster.translation() = support_from_map * types::from<Vector3d>(cluster.centroid.get());
    std::vector<Vector2d> outline;
    for (const Vector3d& corner : types::points_from_values(support.outline.get()))
      outline.push_back((support_from_map * corner).head<2>());
    const std::string place = support.name.get();
    std::string sentence = place_phrase(place, support.support_class.get());
    if (const types::Cluster below = cluster.stands_on.get()) {
      const auto number = std::find(all.begin(), all.end(), below) - all.begin() + 1;
      sentence = fmt::format("on top of cluster {} {}", number, sentence);
    }
    if (const std::string edge = edge_phrase(place_from_cluster.translation().head<2>(), outline);
        !edge.empty())
      sentence += ", " + edge;
    const auto annotation = types::TFLocationAnnotation::create(cas);
    annotation.source.set(descriptor().name);
    if (!place.empty()) annotation.frame_id.set(place);
    annotation.pose.set(types::to(cas, place_from_cluster));
    annotation.sentence.set(sentence);
    cluster.annotations.push_back(annotation);
    if (!place.empty()) cluster.place.set(place);
    cluster.place_from_cluster.set(types::to(cas, place_from_cluster));
  }
}

}  // namespace loci::perception
