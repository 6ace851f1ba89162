#include "perception/annotators/description/object_views.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "mapping/base/math/math.h"
#include "perception/annotators/scene_data.h"
#include "perception/cas/graph.h"

namespace loci::perception {
namespace {

cv::Vec3f to_pixel(const Eigen::Vector3f& value) {
  return {value.x(), value.y(), value.z()};
}

/// What the belief decided, whatever simple trackers vote for; -1 = nothing.
int64_t tracking_id_of(const types::Cluster& cluster) {
  int64_t id = -1;
  for (const auto& tracking : cluster.annotations.filter<types::TrackingAnnotation>())
    if (tracking.annotator_id.get() == tracking.source.get()) id = tracking.tracking_id.get();
  return id;
}

/// A copier that leaves clusters and the scene where they are.
cas::Copier copier(const types::SceneCas& scene, cas::Cas& to) {
  cas::Copier copy(scene.cas(), to);
  copy.stand_in(scene.scene(), {});
  for (const types::Cluster& cluster : scene.scene().clusters) copy.stand_in(cluster, {});
  return copy;
}

}  // namespace

AnnotatorDescriptor ObjectViews::descriptor() const {
  return {"ObjectViews",
          "Creates a CAS for each object from its views over time: merged into one cluster, or one cluster "
          "per view.",
          {"Scene", "CameraInfo", "Cluster", "ReferenceClusterPoints", "view:cloud", "view:normals"},
          {"Scene", "CameraInfo", "Cluster", "ReferenceClusterPoints", "StandaloneImageROI", "PlanarSupport",
           "view:cloud", "view:normals"},
          {"PlanarSupport", "StandaloneImageROI", "Annotation"}};
}

void ObjectViews::declare(OptionTable& table) {
  table.text("as", as_, "One cluster of all points, or one cluster per view.", {"whole", "views"});
  table.integer("last", last_, "", "Number of views stored per object.", 1, 1000);
  table.number("apart_deg", apart_deg_, "deg",
               "A view replaces older views from directions closer than this angle.", 0, 180);
  table.number("place_m", place_m_, "m",
               "Maximum distance between the centre of an object and the box of another for both to be the "
               "same untracked object.",
               0, 1);
  table.integer("max_points", max_points_, "", "Maximum number of points stored per view.", 10, 1000000);
  table.integer("forget", forget_, "", "Number of scenes after which an object that is not seen is dropped.",
                1, 1000000);
}

ObjectViews::View ObjectViews::view_of(const types::SceneCas& scene, const types::Cluster& cluster) const {
  View view;
  const Isometry3d pose = map_from_camera(scene.scene());
  const Eigen::Isometry3f map_from_points = pose.cast<float>();
  view.seen_from = pose.translation();
  const cv::Mat points = cloud_points(scene), normals = cloud_normals(scene);
  const cas::Buffer<int32_t> indices = cluster_indices(cluster);
  const size_t step = 1 + indices.size() / static_cast<size_t>(max_points_);
  for (size_t i = 0; i < indices.size(); i += step) {
    const Eigen::Vector3f point = to_vector3f(points.ptr<cv::Vec3f>()[indices[i]]);
    const Eigen::Vector3f normal = to_vector3f(normals.ptr<cv::Vec3f>()[indices[i]]);
    if (!point.allFinite()) continue;
    view.points.push_back(map_from_points * point);
    view.normals.push_back(map_from_points.linear() * normal);
  }
  view.cas = std::make_unique<cas::Cas>(scene.cas().shared_type_system());
  view.cluster = types::Cluster::create(*view.cas);
  cas::Copier copy = copier(scene, *view.cas);
  for (const auto& roi : cluster.hypotheses.filter<types::StandaloneImageROI>())
    view.cluster.hypotheses.push_back(types::ObjectHypothesis(copy(roi)));
  for (const types::Annotation& annotation : cluster.annotations)
    view.cluster.annotations.push_back(types::Annotation(copy(annotation)));
  view.cluster.at_image_border.set(cluster.at_image_border.get());
  view.cluster.partly_hidden.set(cluster.partly_hidden.get());
  return view;
}

ObjectViews::Object& ObjectViews::object_of(const types::Cluster& cluster, const View& view,
                                            std::set<const Object*>& taken) {
  const int64_t id = tracking_id_of(cluster);
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3f& point : view.points) box.extend(point.cast<double>());
  Object* best = nullptr;
  double nearest = std::numeric_limits<double>::infinity();
  for (Object& object : objects_) {
    if (taken.contains(&object) || object.tracking_id != id) continue;
    const bool there = object.box.exteriorDistance(box.center()) <= place_m_ &&
                       box.exteriorDistance(object.box.center()) <= place_m_;
    const double away = (object.box.center() - box.center()).norm();
    if ((id < 0 && !there) || away >= nearest) continue;
    best = &object;
    nearest = away;
  }
  if (best == nullptr) {
    best = &objects_.emplace_back();
    best->tracking_id = id;
  }
  taken.insert(best);
  best->seen = scene_;
  return *best;
}

void ObjectViews::add_view(Object& object, View view) const {
  Vector3d centre = Vector3d::Zero();
  for (const Eigen::Vector3f& point : view.points) centre += point.cast<double>();
  centre /= std::max<double>(1, static_cast<double>(view.points.size()));
  std::erase_if(object.views, [&](const View& older) {
    const Vector3d one = view.seen_from - centre, two = older.seen_from - centre;
    return std::atan2(one.cross(two).norm(), one.dot(two)) < apart_deg_ * kPi / 180;
  });
  object.views.push_front(std::move(view));
  if (object.views.size() > static_cast<size_t>(last_)) object.views.pop_back();
  object.box.setEmpty();
  for (const View& each : object.views)
    for (const Eigen::Vector3f& point : each.points) object.box.extend(point.cast<double>());
}

std::vector<std::unique_ptr<cas::Cas>> ObjectViews::split(cas::Cas& cas, Context& /*context*/) {
  const types::SceneCas scene(cas);
  ++scene_;
  parts_.clear();
  std::vector<std::unique_ptr<cas::Cas>> made;
  std::set<const Object*> taken;
  for (const types::Cluster& cluster : scene.clusters()) {
    View view = view_of(scene, cluster);
    if (view.points.empty()) continue;
    Object& object = object_of(cluster, view, taken);
    add_view(object, std::move(view));
    made.push_back(make_part(scene, cluster, object));
  }
  objects_.remove_if([&](const Object& object) { return scene_ - object.seen > forget_; });
  return made;
}

void ObjectViews::join(size_t number, cas::Cas& done, cas::Cas& scene) {
  const Part& part = parts_[number];
  const types::SceneCas inside(done);
  cas::Copier copy = copier(inside, scene);
  copy.stand_in(part.cluster, part.original);
  const std::vector<types::PlanarSupport> supports = types::SceneCas(scene).supports();
  const std::vector<types::PlanarSupport> copies = inside.supports();
  for (size_t i = 0; i < std::min(supports.size(), copies.size()); ++i) copy.stand_in(copies[i], supports[i]);
  for (const types::Annotation& annotation : part.cluster.annotations) {
    if (annotation.structure().id() <= part.known) continue;
    if (as_ == "whole" && part.views > 1) annotation.views.set(part.views);
    part.original.annotations.push_back(types::Annotation(copy(annotation)));
  }
}

/// Gives a cluster of a part its points.
void ObjectViews::add_points(const types::SceneCas& part, const types::Cluster& cluster,
                             const std::vector<int32_t>& indices, const Vector3d& centroid) {
  const auto reference = types::ReferenceClusterPoints::create(part.cas());
  reference.source.set("ObjectViews");
  reference.cloud.set(part.cloud());
  reference.indices.get_or_create().indices.set(indices);
  cluster.hypotheses.push_back(reference);
  cluster.centroid.set(types::to(part.cas(), centroid));
  part.add_cluster(cluster);
}

std::unique_ptr<cas::Cas> ObjectViews::make_part(const types::SceneCas& scene, const types::Cluster& original,
                                                 const Object& object) {
  auto made = std::make_unique<cas::Cas>(scene.cas().shared_type_system());
  const types::SceneCas part(*made);
  const types::Scene from = scene.scene(), to = part.create_scene();
  to.timestamp.set(from.timestamp.get());
  to.frame_index.set(from.frame_index.get());
  cas::Copier copy = copier(scene, *made);
  to.map_from_camera.set(types::StampedTransform(copy(from.map_from_camera.get())));
  for (const types::CameraInfo& camera : from.cameras) part.set_camera(types::CameraInfo(copy(camera)));
  for (const types::PlanarSupport& support : scene.supports())
    part.add_support(types::PlanarSupport(copy(support)));

  const bool whole = as_ == "whole";
  const Eigen::Isometry3f camera_from_map = map_from_camera(from).inverse().cast<float>();
  std::vector<cv::Vec3f> points, normals;
  std::vector<types::Cluster> clusters;
  std::vector<std::vector<int32_t>> indices;
  std::vector<Vector3d> sums;
  for (const View& view : object.views) {
    if (clusters.empty() || !whole) {
      cas::Copier from_view(*view.cas, *made);
      const types::Cluster cluster(from_view(view.cluster));
      if (const types::PlanarSupport support = original.support.get())
        cluster.support.set(types::PlanarSupport(copy(support)));
      if (original.place.is_set()) cluster.place.set(original.place.get());
      clusters.push_back(cluster);
      indices.emplace_back();
      sums.emplace_back(Vector3d::Zero());
    }
    // The whole is cut off where every view is.
    const types::Cluster& cluster = clusters.back();
    cluster.at_image_border.set(cluster.at_image_border.get() && view.cluster.at_image_border.get());
    cluster.partly_hidden.set(cluster.partly_hidden.get() && view.cluster.partly_hidden.get());
    for (size_t i = 0; i < view.points.size(); ++i) {
      indices.back().push_back(static_cast<int32_t>(points.size()));
      sums.back() += view.points[i].cast<double>();
      points.push_back(to_pixel(Eigen::Vector3f(camera_from_map * view.points[i])));
      normals.push_back(to_pixel(Eigen::Vector3f(camera_from_map.linear() * view.normals[i])));
    }
  }
  set_cloud_points(part, cv::Mat(points, true).reshape(3, 1));
  set_cloud_normals(part, cv::Mat(normals, true).reshape(3, 1));
  for (size_t i = 0; i < clusters.size(); ++i)
    add_points(part, clusters[i], indices[i], sums[i] / static_cast<double>(indices[i].size()));
  parts_.push_back({original, clusters.front(), made->size(), static_cast<int>(object.views.size())});
  return made;
}

}  // namespace loci::perception
