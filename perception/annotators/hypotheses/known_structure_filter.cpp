#include "perception/annotators/hypotheses/known_structure_filter.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <limits>

#include "perception/annotators/hypotheses/support_planes.h"
#include "perception/annotators/scene_data.h"
#include "perception/conversions/camera.h"
#include "perception/conversions/opencv.h"

namespace loci::perception {
namespace {

constexpr int kFewPixels = 200;  ///< A region with fewer is not in view.

JointState joints_of(const types::Scene& scene, const KnownMap& map, Warnings& warnings) {
  JointState joints;
  if (!scene.joint_state.is_set()) return joints;
  const types::JointState state = scene.joint_state.get();
  const std::vector<std::string> names = state.names.to_vector();
  const std::vector<double> positions = state.positions.to_vector();
  for (size_t i = 0; i < std::min(names.size(), positions.size()); ++i) {
    joints[names[i]] = positions[i];
    if (!map.world.find_joint(names[i]) && !map.robot_has_joint(names[i]))
      warnings.add("the map has no joint '" + names[i] + "', which the recording moves");
  }
  return joints;
}

JointState joints_of_map(const JointState& joints, const mapping::World& world) {
  JointState known;
  for (const auto& [name, position] : joints)
    if (world.find_joint(name)) known[name] = position;
  return known;
}

void add_region(const types::SceneCas& scene, const Region& region, const cv::Mat& labels, int label,
                const KnownStructureOptions& options) {
  cas::Cas& cas = scene.cas();
  const SupportSurface& surface = *region.surface;
  Eigen::AlignedBox2d extent;
  for (const Vector2d& corner : surface.outline) extent.extend(corner);
  const Vector2d centre = extent.center();
  const Vector2d size = extent.sizes();
  Isometry3d link_from_box = surface.link_from_top;
  link_from_box = link_from_box * Eigen::Translation3d(centre.x(), centre.y(), options.region_height_m / 2);
  const auto roi = types::RegionOfInterest::create(cas);
  roi.name.set(surface.link);
  roi.frame_id.set(surface.link);
  const auto box = roi.bbox.get_or_create();
  box.pose.set(types::to(cas, link_from_box));
  box.size.set(types::to(cas, Vector3d(size.x(), size.y(), options.region_height_m)));
  scene.scene().regions.push_back(roi);

  const auto mask = types::SegmentationLocationAnnotation::create(cas);
  mask.source.set("KnownStructureFilter");
  mask.frame_id.set(surface.link);
  mask.mask.set(types::to(cas, cv::Mat(labels == label)));
  mask.add_to_index(kRegionsView);

  const auto support = types::PlanarSupport::create(cas);
  support.name.set(surface.link);
  support.support_class.set(surface.class_name);
  const Vector3d normal = region.map_from_top.linear().col(2);
  support.normal.set(types::to(cas, normal));
  support.offset.set(normal.dot(region.map_from_top.translation()));
  support.height.set(region.map_from_top.translation().z());
  support.map_from_support.set(types::to(cas, region.map_from_top));
  std::vector<Vector3d> outline;
  for (const Vector2d& corner : surface.outline)
    outline.push_back(region.map_from_top * Vector3d(corner.x(), corner.y(), 0));
  support.outline.set(types::values_from_points(outline));
  scene.add_support(support);
}

void annotate_joint(const types::SceneCas& scene, const FrontState& front) {
  const auto annotation = types::JointAnnotation::create(scene.cas());
  annotation.source.set("KnownStructureFilter");
  annotation.joint.set(front.joint);
  annotation.given.set(front.given);
  annotation.position.set(front.position);
  annotation.moved.set(front.moved);
  annotation.points.set(front.in_view);
  annotation.confidence.set(static_cast<double>(front.on) / std::max(1, front.in_view));
  scene.scene().annotations.push_back(annotation);
}

void annotate_obstacle(const types::SceneCas& scene, const Obstacle& obstacle) {
  const auto annotation = types::ObstacleAnnotation::create(scene.cas());
  annotation.source.set("KnownStructureFilter");
  annotation.joint.set(obstacle.joint);
  annotation.distance.set(obstacle.distance_m);
  annotation.share.set(obstacle.share);
  scene.scene().annotations.push_back(annotation);
}

}  // namespace

AnnotatorDescriptor KnownStructureFilter::descriptor() const {
  return {"KnownStructureFilter",
          "Removes what the map explains (walls, floor, sides of furniture) and keeps the regions above "
          "supports.",
          {"Scene", "view:cloud", "view:normals", "CameraInfo"},
          {"RegionOfInterest", "SegmentationLocationAnnotation", "JointAnnotation", "ObstacleAnnotation",
           "view:regions", "view:structure", "view:map_depth"},
          {"JointState"},
          {"Scene", "JointState", "PlanarSupport"}};
}

void KnownStructureFilter::declare(OptionTable& table) {
  options_.declare(table);
  refinement_.declare(table);
  table.flag("fit_joints", fit_joints_,
             "Fits drawers and doors whose joints the recording does not name by their fronts.");
  table.text("camera_link", camera_link_,
             "Link of a robot that is the depth camera (optical frame): the robot is where the camera is.");
}

void KnownStructureFilter::start(Context& context) {
  map_ = context.resources.find<KnownMap>();
  if (!map_ || !map_->has_room()) return;
  surfaces_ = map_->support_surfaces(options_.regions);
  if (surfaces_.empty())
    throw Error(fmt::format("no link of the map matches the regions {}", fmt::join(options_.regions, ", ")),
                {}, "name the links that objects stand on: KnownStructureFilter: {regions: [...]}");
  fronts_ = std::make_unique<ArticulatedFronts>(map_->world, map_->meshes);
}

/// The pose of the camera, fitted to the map; the scene is told when it moves.
Isometry3d KnownStructureFilter::refined_pose(const types::SceneCas& facade, const cv::Mat& points,
                                              const mapping::PinholeCamera& camera, Context& context) {
  const types::Scene scene = facade.scene();
  const Isometry3d given = map_from_camera(scene);
  if (!refinement_.refine_pose || !has_measured_pose(scene)) return given;
  const PoseRefinement refinement =
      refine_pose(points, cloud_normals(facade), camera, given, map_->scene, refinement_, context.threads);
  facade.log(
      "KnownStructureFilter", "info",
      fmt::format("pose of the camera: {} ({:.0f} % of the points on the map, {:.0f} % before)",
                  refinement.verdict, 100 * refinement.explained_after, 100 * refinement.explained_before));
  if (!refinement.moved) return given;
  const types::StampedTransform stamp = scene.map_from_camera.get();
  scene.map_from_camera.set(types::to_stamped(facade.cas(), refinement.map_from_camera, stamp.frame_id.get(),
                                              stamp.child_frame_id.get(), stamp.timestamp.get()));
  return refinement.map_from_camera;
}

void KnownStructureFilter::fit_joints(const types::SceneCas& scene, const cv::Mat& points,
                                      const mapping::PinholeCamera& camera, const Isometry3d& pose,
                                      int threads, JointState& joints) {
  if (!fit_joints_) return;
  JointState fitted = joints;
  for (const FrontState& front : fronts_->estimate(points, camera, pose, joints, threads)) {
    if (front.determined) annotate_joint(scene, front);
    if (!front.moved || joints.contains(front.joint)) continue;
    fitted[front.joint] = front.position;
    scene.log("KnownStructureFilter", "info",
              fmt::format("{} stands at {:.3f}: {} of {} points of its front", front.joint, front.position,
                          front.on, front.in_view));
  }
  if (fitted == joints) return;
  joints = fitted;
  map_->scene.set_joints(map_->part, joints);
  std::vector<std::string> names;
  std::vector<double> positions;
  for (const auto& [name, position] : joints) {
    names.push_back(name);
    positions.push_back(position);
  }
  const auto state = scene.scene().joint_state.get_or_create();
  state.names.set(names);
  state.positions.set(positions);
}

/// Without a room the robots' points simply go.
void KnownStructureFilter::remove_robots(const types::SceneCas& facade, const mapping::PinholeCamera& camera,
                                         Context& context) {
  const types::Scene scene = facade.scene();
  const Isometry3d pose = scene.map_from_camera.is_set() ? map_from_camera(scene) : Isometry3d::Identity();
  map_->place_robots(scene.timestamp.get(), joints_of(scene, *map_, context.warnings), camera_link_, pose);
  cv::Mat points = cloud_points(facade).clone();
  const KnownStructure known =
      find_known_structure(points, camera, pose, *map_, {}, {}, options_, context.threads);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  points.setTo(cv::Scalar::all(static_cast<double>(nan)),
               known.kind == static_cast<int>(mapping::PixelKind::map_explained));
  cv::Mat normals = cloud_normals(facade).clone();
  normals.setTo(cv::Scalar::all(static_cast<double>(nan)),
                known.kind == static_cast<int>(mapping::PixelKind::map_explained));
  set_cloud_points(facade, points);
  set_cloud_normals(facade, normals);
  types::set_view_image(facade, kStructureView, known.kind);
  facade.log("KnownStructureFilter", "info", fmt::format("{} points on robots", known.known));
}

void KnownStructureFilter::tell_obstacles(const types::SceneCas& scene, const cv::Mat& points,
                                          const mapping::PinholeCamera& camera, const Isometry3d& pose,
                                          const JointState& joints, const cv::Mat& map_depth) {
  cv::Mat unknown(points.size(), CV_8U);
  const auto* point = points.ptr<cv::Vec3f>();
  const auto* model = map_depth.ptr<float>();
  auto* out = unknown.ptr<uint8_t>();
  for (int i = 0; i < points.rows * points.cols; ++i) {
    const auto z = static_cast<double>(point[i][2]);
    out[i] = static_cast<double>(model[i]) - z > options_.epsilon_m + 2 * depth_noise(z) ? 1 : 0;
  }
  for (const Obstacle& obstacle : fronts_->obstacles(points, unknown, camera, pose, joints)) {
    annotate_obstacle(scene, obstacle);
    scene.log("KnownStructureFilter", "info",
              fmt::format("something stands {:.2f} m before {} and hides {:.0f} % of it", obstacle.distance_m,
                          obstacle.joint, 100 * obstacle.share));
  }
}

void KnownStructureFilter::process(cas::Cas& cas, Context& context) {
  const types::SceneCas facade(cas);
  const types::Scene scene = facade.scene();
  if (!map_) {
    facade.log("KnownStructureFilter", "info", "no map: nothing is known, nothing is removed");
    return;
  }
  const mapping::PinholeCamera camera = types::cameras(facade).depth;
  if (!map_->has_room()) {
    remove_robots(facade, camera, context);
    return;
  }
  if (!scene.map_from_camera.is_set()) {
    facade.log("KnownStructureFilter", "warning", "without a pose the map cannot be compared");
    return;
  }
  const JointState all_joints = joints_of(scene, *map_, context.warnings);
  JointState joints = joints_of_map(all_joints, map_->world);
  map_->scene.set_joints(map_->part, joints);
  map_->hide_robots();
  const cv::Mat points = cloud_points(facade);
  const Isometry3d pose = refined_pose(facade, points, camera, context);
  fit_joints(facade, points, camera, pose, context.threads, joints);
  map_->place_robots(scene.timestamp.get(), all_joints, camera_link_, pose);
  KnownStructure known =
      find_known_structure(points, camera, pose, *map_, surfaces_, joints, options_, context.threads);
  tell_obstacles(facade, points, camera, pose, joints, known.map_depth);
  // Regions out of view are left out, the others numbered from 1 in the order of the scene's supports.
  std::vector<uint16_t> number(known.regions.size() + 1, 0);
  uint16_t next = 0;
  for (size_t r = 0; r < known.regions.size(); ++r)
    if (known.regions[r].pixels >= kFewPixels) number[r + 1] = ++next;
  auto* label = known.region.ptr<uint16_t>();
  for (size_t i = 0; i < known.region.total(); ++i) label[i] = number[label[i]];
  for (size_t r = 0; r < known.regions.size(); ++r)
    if (number[r + 1] > 0) add_region(facade, known.regions[r], known.region, number[r + 1], options_);
  types::set_view_image(facade, kRegionsView, known.region);
  types::set_view_image(facade, kStructureView, known.kind);
  types::set_view_image(facade, kMapDepthView, known.map_depth);
  facade.log(
      "KnownStructureFilter", "info",
      fmt::format("{} points known, {} in no region, {} regions in view", known.known, known.outside, next));
}

}  // namespace loci::perception
