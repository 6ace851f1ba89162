#include "perception/annotators/description/geometry_annotators.h"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "mapping/base/math/math.h"
#include "perception/annotators/scene_data.h"
#include "perception/conversions/opencv.h"

namespace loci::perception {
namespace {

struct Range {
  double low;
  double high;
};

Range range_of(std::vector<double> values, double outliers) {
  const auto [low, high] = quantiles(values, outliers, 1 - outliers);
  return {low, high};
}

/// What is needed of a cluster, once.
struct RelatedObject {
  types::Cluster cluster;
  Footprint footprint;
  Vector3d size;
};

std::vector<RelatedObject> objects_of(const types::SceneCas& scene) {
  std::vector<RelatedObject> objects;
  for (const types::Cluster& cluster : scene.clusters()) {
    const auto geometry = cluster.annotations.first<types::GeometryAnnotation>();
    if (!geometry) continue;
    const auto pose = types::from<Isometry3d>(geometry.map_from_object.get());
    const auto size = types::from<Vector3d>(geometry.size.get());
    const Vector3d x = pose.linear().col(0);
    objects.push_back(
        {cluster, {pose.translation().head<2>(), size.head<2>() / 2, std::atan2(x.y(), x.x())}, size});
  }
  return objects;
}

/// Colours that both show, times how alike their sizes are; negative = not known.
double color_similarity(const RelatedObject& a, const RelatedObject& b) {
  const auto first = a.cluster.annotations.first<types::ColorHistogram>(),
             second = b.cluster.annotations.first<types::ColorHistogram>();
  if (!first || !second) return -1;
  const auto p = first.histogram.get(), q = second.histogram.get();
  if (p.size() != q.size() || p.size() == 0) return -1;
  double common = 0;
  for (size_t i = 0; i < p.size(); ++i) common += static_cast<double>(std::min(p[i], q[i]));
  Vector3d own = a.size, other = b.size;
  std::sort(own.begin(), own.end());
  std::sort(other.begin(), other.end());
  return common * std::cbrt(own.cwiseMin(other).prod() / std::max(own.cwiseMax(other).prod(), 1e-12));
}

}  // namespace

UprightBox upright_box(const std::vector<Vector3d>& points, double ground, double reach, double outliers) {
  UprightBox box;
  if (points.empty()) return box;
  std::vector<cv::Point2f> footprint;
  std::vector<double> heights;
  footprint.reserve(points.size());
  heights.reserve(points.size());
  const Vector3d& origin = points.front();  // Floats lose digits far from the map's origin.
  for (const Vector3d& p : points) {
    footprint.emplace_back(static_cast<float>(p.x() - origin.x()), static_cast<float>(p.y() - origin.y()));
    heights.push_back(p.z());
  }
  const cv::RotatedRect rectangle = cv::minAreaRect(types::near_hull(footprint));
  double yaw = static_cast<double>(rectangle.angle) * kPi / 180;
  if (rectangle.size.height > rectangle.size.width) yaw += kPi / 2;
  yaw = std::remainder(yaw, kPi);
  const Vector2d x(std::cos(yaw), std::sin(yaw));
  const Vector2d y(-x.y(), x.x());
  std::vector<double> along;
  std::vector<double> across;
  along.reserve(points.size());
  across.reserve(points.size());
  for (const Vector3d& p : points) {
    along.push_back(x.dot(p.head<2>()));
    across.push_back(y.dot(p.head<2>()));
  }
  const Range a = range_of(std::move(along), outliers);
  const Range b = range_of(std::move(across), outliers);
  Range z = range_of(std::move(heights), outliers);
  if (z.low > ground && z.low - ground < reach) z.low = ground;
  const Vector2d centre = x * (a.low + a.high) / 2 + y * (b.low + b.high) / 2;
  box.map_from_box.linear() = Eigen::AngleAxisd(yaw, Vector3d::UnitZ()).toRotationMatrix();
  box.map_from_box.translation() = Vector3d(centre.x(), centre.y(), (z.low + z.high) / 2);
  box.size = {a.high - a.low, b.high - b.low, z.high - z.low};
  return box;
}

AnnotatorDescriptor GeometryAnnotator::descriptor() const {
  return {"GeometryAnnotator",
          "Fits an upright box to each object, in the map frame and in the frame of its place.",
          {"Scene", "Cluster", "ReferenceClusterPoints", "PlanarSupport", "view:cloud"},
          {"GeometryAnnotation"}};
}

void GeometryAnnotator::declare(OptionTable& table) {
  table.number("outliers", outliers_, "", "Share of the points that is ignored at each end of an axis.", 0,
               0.2);
  table.number("ground_m", ground_m_, "m",
               "Boxes that end closer than this above the support are extended down to it.", 0, 1);
}

void GeometryAnnotator::process(cas::Cas& cas, Context& /*context*/) {
  const types::SceneCas facade(cas);
  for (const types::Cluster& cluster : facade.clusters()) {
    const std::vector<Vector3d> points = cluster_points(facade, cluster);
    if (points.empty()) continue;
    const types::PlanarSupport support = cluster.support.get();
    double ground = -std::numeric_limits<double>::infinity();
    const Vector3d centroid = types::from<Vector3d>(cluster.centroid.get());
    double highest = 0;
    if (support) {
      const Vector3d normal = types::from<Vector3d>(support.normal.get());
      const double offset = support.offset.get();
      ground = (offset - normal.head<2>().dot(centroid.head<2>())) / normal.z();
      for (const Vector3d& p : points) highest = std::max(highest, normal.dot(p) - offset);
    }
    const UprightBox box = upright_box(points, ground, ground_m_, outliers_);
    const auto annotation = types::GeometryAnnotation::create(cas);
    annotation.source.set(descriptor().name);
    annotation.map_from_object.set(types::to(cas, box.map_from_box));
    annotation.size.set(types::to(cas, box.size));
    if (support) {
      annotation.height.set(highest);
      const Isometry3d map_from_support = types::from<Isometry3d>(support.map_from_support.get());
      annotation.place_from_object.set(
          types::to(cas, Isometry3d(map_from_support.inverse() * box.map_from_box)));
      if (support.name.is_set()) annotation.place.set(support.name.get());
    }
    cluster.annotations.push_back(annotation);
  }
}

std::string edge_phrase(const Vector2d& position, const std::vector<Vector2d>& outline) {
  if (outline.size() < 3) return {};
  std::array<std::pair<double, const char*>, 4> edges = {
      {{1e9, "left"}, {1e9, "right"}, {1e9, "front"}, {1e9, "back"}}};
  for (size_t i = 0; i < outline.size(); ++i) {
    const Vector2d a = outline[i] - position, b = outline[(i + 1) % outline.size()] - position;
    for (int axis = 0; axis < 2; ++axis) {  // where the edge crosses the line through the position
      const int other = 1 - axis;
      if ((a[other] > 0) == (b[other] > 0)) continue;
      const double at = a[axis] - a[other] * (b[axis] - a[axis]) / (b[other] - a[other]);
      // Counter-clockwise, edges at the right go backwards, those at the back to the left.
      const bool far_side = (b[other] > a[other]) == (axis == 0);
      double& nearest = edges[static_cast<size_t>(2 * axis + (far_side ? 1 : 0))].first;
      nearest = std::min(nearest, std::abs(at));
    }
  }
  const auto nearest = std::ranges::min_element(edges);
  if (nearest->first == 1e9) return {};
  return fmt::format("{:.2f} m from its {} edge", nearest->first, nearest->second);
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
          "Determines the place of each object and its distance from the edge of the place.",
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

bool Footprint::holds(const Vector2d& point) const {
  const Vector2d from = Eigen::Rotation2Dd(-yaw) * (point - centre);
  return std::abs(from.x()) <= half.x() && std::abs(from.y()) <= half.y();
}

std::vector<Vector2d> Footprint::spread() const {
  constexpr int kSide = 7;
  std::vector<Vector2d> points;
  for (int i = 0; i < kSide; ++i)
    for (int j = 0; j < kSide; ++j) {
      const Vector2d part((2 * i + 1.0) / kSide - 1, (2 * j + 1.0) / kSide - 1);
      points.emplace_back(centre + Eigen::Rotation2Dd(yaw) * part.cwiseProduct(half));
    }
  return points;
}

Arrangement arrangement_of(const Footprint& a, const Footprint& b, const Vector2d& away) {
  const Vector2d right(away.y(), -away.x());
  const std::vector<Vector2d> of_a = a.spread(), of_b = b.spread();
  Arrangement arrangement;
  const double share = 1 / static_cast<double>(of_a.size() * of_b.size());
  arrangement.gap_m = (a.centre - b.centre).norm();
  for (const Vector2d& p : of_a) {
    arrangement.over += b.holds(p) ? 1 / static_cast<double>(of_a.size()) : 0;
    for (const Vector2d& q : of_b) {
      const Vector2d from = p - q;
      const double side = right.dot(from), far = away.dot(from);
      arrangement.gap_m = std::min(arrangement.gap_m, from.norm());
      if (std::abs(side) >= std::abs(far))
        (side < 0 ? arrangement.left_of : arrangement.right_of) += share;
      else
        (far < 0 ? arrangement.in_front_of : arrangement.behind) += share;
    }
  }
  // The outer points lie half a cell within.
  const double cell = (a.half.norm() + b.half.norm()) / 14;
  arrangement.gap_m = arrangement.over > 0 ? 0 : std::max(0.0, arrangement.gap_m - cell);
  return arrangement;
}

AnnotatorDescriptor RelationsAnnotator::descriptor() const {
  return {"Relations",
          "Computes spatial relations between objects from the camera's view, with probabilities.",
          {"Scene", "Cluster", "PlanarSupport", "GeometryAnnotation"},
          {"Relation"},
          {"ColorHistogram"},
          {"Scene.relations"}};
}

void RelationsAnnotator::declare(OptionTable& table) {
  table.number("near_m", near_m_, "m",
               "Distance at which two objects are near each other with probability 0.5.", 0.005, 10);
  table.number("reach_m", reach_m_, "m", "Maximum distance for directional relations.", 0.01, 10);
  table.number("min_probability", min_probability_, "", "Minimum probability of a relation.", 0, 1);
}

void RelationsAnnotator::process(cas::Cas& cas, Context& /*context*/) {
  const types::SceneCas scene(cas);
  const std::vector<RelatedObject> objects = objects_of(scene);
  const Vector2d view = map_from_camera(scene.scene()).linear().col(2).head<2>();
  // A camera that looks straight down sees its image's top as away.
  const Vector2d top = -map_from_camera(scene.scene()).linear().col(1).head<2>();
  const Vector2d away = (view.norm() > 0.1 ? view : top).normalized();
  const auto say = [&](const char* name, const types::Identifiable& a, const types::Identifiable& b,
                       double probability) {
    if (probability < min_probability_) return;
    const auto relation = types::Relation::create(cas);
    relation.source.set(descriptor().name);
    relation.name.set(name);
    relation.object1.set(a);
    relation.object2.set(b);
    relation.probability.set(std::min(1.0, probability));
    scene.scene().relations.push_back(relation);
  };
  for (size_t i = 0; i < objects.size(); ++i) {
    const types::Cluster& a = objects[i].cluster;
    if (const types::PlanarSupport support = a.support.get(); support && !a.stands_on.get())
      say("on", a, support, 1);
    for (size_t j = 0; j < objects.size(); ++j) {
      const types::Cluster& b = objects[j].cluster;
      if (i == j) continue;
      const Arrangement lie = arrangement_of(objects[i].footprint, objects[j].footprint, away);
      if (a.stands_on.get() == b) say("on-top-of", a, b, lie.over);
      if (i < j) say("similar-appearance", a, b, color_similarity(objects[i], objects[j]));
      if (lie.gap_m > reach_m_ || !(a.support.get() == b.support.get())) continue;
      if (i < j) say("near", a, b, std::exp2(-std::pow(lie.gap_m / near_m_, 2)));
      if (lie.over > 0) continue;
      say("left-of", a, b, lie.left_of);
      say("in-front-of", a, b, lie.in_front_of);
    }
  }
}

}  // namespace loci::perception
