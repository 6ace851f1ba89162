#include "perception/annotators/description/relations_annotator.h"

#include <algorithm>
#include <cmath>

#include "perception/annotators/scene_data.h"

namespace loci::perception {
namespace {

/// What is needed of a cluster, once.
struct Thing {
  types::Cluster cluster;
  Footprint footprint;
  Vector3d size;
};

std::vector<Thing> things_of(const types::SceneCas& scene) {
  std::vector<Thing> things;
  for (const types::Cluster& cluster : scene.clusters()) {
    const auto geometry = cluster.annotations.first<types::GeometryAnnotation>();
    if (!geometry) continue;
    const auto pose = types::from<Isometry3d>(geometry.map_from_object.get());
    const auto size = types::from<Vector3d>(geometry.size.get());
    const Vector3d x = pose.linear().col(0);
    things.push_back(
        {cluster, {pose.translation().head<2>(), size.head<2>() / 2, std::atan2(x.y(), x.x())}, size});
  }
  return things;
}

/// Colours that both show, times how alike their sizes are; negative = not known.
double likeness(const Thing& a, const Thing& b) {
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
          "Says how objects lie to each other as the camera sees it, each with a probability.",
          {"Scene", "Cluster", "PlanarSupport", "GeometryAnnotation"},
          {"Relation"},
          {"ColorHistogram"},
          {"Scene.relations"}};
}

void RelationsAnnotator::declare(OptionTable& table) {
  table.number("near_m", near_m_, "m", "Things are near with probability one half at this distance.", 0.005,
               10);
  table.number("reach_m", reach_m_, "m", "Things farther apart have no direction to each other.", 0.01, 10);
  table.number("min_probability", min_probability_, "", "What is less probable is not said.", 0, 1);
}

void RelationsAnnotator::process(cas::Cas& cas, Context& /*context*/) {
  const types::SceneCas scene(cas);
  const std::vector<Thing> things = things_of(scene);
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
  for (size_t i = 0; i < things.size(); ++i) {
    const types::Cluster& a = things[i].cluster;
    if (const types::PlanarSupport support = a.support.get(); support && !a.stands_on.get())
      say("on", a, support, 1);
    for (size_t j = 0; j < things.size(); ++j) {
      const types::Cluster& b = things[j].cluster;
      if (i == j) continue;
      const Arrangement lie = arrangement_of(things[i].footprint, things[j].footprint, away);
      if (a.stands_on.get() == b) say("on-top-of", a, b, lie.over);
      if (i < j) say("similar-appearance", a, b, likeness(things[i], things[j]));
      if (lie.gap_m > reach_m_ || !(a.support.get() == b.support.get())) continue;
      if (i < j) say("near", a, b, std::exp2(-std::pow(lie.gap_m / near_m_, 2)));
      if (lie.over > 0) continue;
      say("left-of", a, b, lie.left_of);
      say("in-front-of", a, b, lie.in_front_of);
    }
  }
}

}  // namespace loci::perception
