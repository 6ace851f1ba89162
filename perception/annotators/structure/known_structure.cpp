#include "perception/annotators/structure/known_structure.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>

#include "mapping/base/math/log_odds.h"
#include "mapping/base/parallel.h"
#include "mapping/world/free_standing.h"
#include "perception/annotators/scene_data.h"
#include "perception/annotators/structure/articulated_fronts.h"
#include "perception/annotators/structure/supports.h"
#include "perception/conversions/opencv.h"

namespace loci::perception {
namespace {

constexpr const char* kStructureFilter = "KnownStructureFilter";
constexpr double kAround = 0.15;  ///< metres

/// A region as its test needs it, prepared once for all points.
struct Prism {
  int region;
  Isometry3d top_from_camera;
  PolygonOutline outline;
};

/// The regions of which something may be in view.
std::vector<Prism> prisms_in_view(const std::vector<Region>& regions, const mapping::PinholeCamera& camera,
                                  const Isometry3d& map_from_camera, const KnownStructureOptions& options) {
  std::vector<Prism> prisms;
  for (size_t r = 0; r < regions.size(); ++r) {
    Eigen::AlignedBox3d box;
    for (const Vector2d& corner : regions[r].surface->outline) {
      box.extend(Vector3d(corner.x(), corner.y(), -options.support_tolerance_m));
      box.extend(Vector3d(corner.x(), corner.y(), options.region_height_m));
    }
    const Isometry3d camera_from_top = map_from_camera.inverse() * regions[r].map_from_top;
    const double around = std::max(kAround, options.margin_m);
    if (out_of_view(camera_from_top * box.center(), box.diagonal().norm() / 2 + around, camera)) continue;
    prisms.push_back(
        {static_cast<int>(r), camera_from_top.inverse(), PolygonOutline(regions[r].surface->outline)});
  }
  return prisms;
}

/// The region with the highest surface below a point; -1 = none. Gives the height over it.
int region_of(const Vector3d& point, const std::vector<Prism>& prisms, const KnownStructureOptions& options,
              double& height) {
  int best = -1;
  for (const Prism& prism : prisms) {
    const double z =
        prism.top_from_camera.linear().row(2).dot(point) + prism.top_from_camera.translation().z();
    if (z < -options.support_tolerance_m || z > options.region_height_m) continue;
    if (best >= 0 && z >= height) continue;
    const Vector2d position = (prism.top_from_camera * point).head<2>();
    // Above the surface the surroundings are kept too, to tell what merely reaches over it.
    const double margin = z > options.support_tolerance_m ? kAround : options.margin_m;
    if (prism.outline.inside(position) < -margin) continue;
    best = prism.region;
    height = z;
  }
  return best;
}

/// Takes more pixels for known structure where they continue it: within kDistortion standard deviations of a
/// surface of the map, facing as it does, and linked to what is explained already through such pixels. Depth
/// cameras distort and maps drift by more than single pixels scatter, so one threshold either leaves patches
/// of a wall or takes what stands before it; two with a link (as in Canny's edge detector) do neither.
void grow_known_structure(const cv::Mat& points, const cv::Mat& normals, const mapping::RenderedView& view,
                          const std::vector<char>& is_surface, const KnownStructureOptions& options,
                          KnownStructure& known) {
  constexpr float kAlike = 0.94f;  // 20 degrees: what leans against a wall is turned from it
  constexpr auto kExplained = static_cast<uint8_t>(mapping::PixelKind::map_explained);
  const auto* point = points.ptr<cv::Vec3f>();
  const auto* normal = normals.ptr<cv::Vec3f>();
  const auto* depth = view.depth.ptr<float>();
  const auto* facing = view.normal.ptr<cv::Vec3f>();
  const auto* link = view.link.ptr<int>();
  auto* kind = known.kind.ptr<uint8_t>();
  auto* label = known.region.ptr<uint16_t>();
  const auto continues = [&](int i) {
    const float z = point[i][2];
    if (std::isnan(z) || kind[i] == kExplained || link[i] < 0 || is_surface[static_cast<size_t>(link[i])])
      return false;
    const double reach = options.epsilon_m + kDistortion * depth_noise(static_cast<double>(z));
    return static_cast<double>(depth[i] - z) <= reach && normal[i].dot(facing[i]) > kAlike;
  };
  std::vector<int> front;
  const auto take_neighbours = [&](int i) {
    const int col = i % points.cols;
    const int row = i / points.cols;
    for (const auto& [du, dv] : {std::pair(-1, 0), {1, 0}, {0, -1}, {0, 1}}) {
      if (col + du < 0 || col + du >= points.cols || row + dv < 0 || row + dv >= points.rows) continue;
      const int next = i + dv * points.cols + du;
      if (!continues(next)) continue;
      if (label[next] > 0) --known.regions[label[next] - 1u].pixels;
      known.outside -= label[next] == 0 ? 1 : 0;
      ++known.known;
      kind[next] = kExplained;
      label[next] = 0;
      front.push_back(next);
    }
  };
  for (int i = 0; i < points.rows * points.cols; ++i)
    if (kind[i] == kExplained && link[i] >= 0 && !is_surface[static_cast<size_t>(link[i])])
      take_neighbours(i);
  while (!front.empty()) {
    const int i = front.back();
    front.pop_back();
    take_neighbours(i);
  }
}

/// Of a part of the image.
struct Counts {
  explicit Counts(size_t regions) : pixels(regions, 0) {}
  int known = 0, outside = 0;
  std::vector<int> pixels;  ///< by region
};

/// A drawer holds what stands no higher than its front, and shut it shows nothing of what it holds.
double height_over(const SupportSurface& surface, const JointState& joints,
                   const KnownStructureOptions& options) {
  if (!surface.drawer) return options.region_height_m;
  const auto at = joints.find(surface.drawer->joint);
  const bool open = at != joints.end() && std::abs(at->second) >= kMinFrontMotion;
  return open ? surface.drawer->height_m : 0;
}

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
      warnings.add("the map has no joint '" + names[i] + "', which the recording moves: it is left out");
  }
  return joints;
}

void add_region(const types::SceneCas& scene, const Region& region, const cv::Mat& labels, int label) {
  cas::Cas& cas = scene.cas();
  const SupportSurface& surface = *region.surface;
  Eigen::AlignedBox2d extent;
  for (const Vector2d& corner : surface.outline) extent.extend(corner);
  const Vector2d centre = extent.center();
  const Vector2d size = extent.sizes();
  Isometry3d link_from_box = surface.link_from_top;
  link_from_box = link_from_box * Eigen::Translation3d(centre.x(), centre.y(), region.height_m / 2);
  const auto roi = types::RegionOfInterest::create(cas);
  roi.name.set(surface.link);
  roi.frame_id.set(surface.link);
  const auto box = roi.bbox.get_or_create();
  box.pose.set(types::to(cas, link_from_box));
  box.size.set(types::to(cas, Vector3d(size.x(), size.y(), region.height_m)));
  scene.scene().regions.push_back(roi);

  const auto mask = types::SegmentationLocationAnnotation::create(cas);
  mask.source.set(kStructureFilter);
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
  annotation.source.set(kStructureFilter);
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
  annotation.source.set(kStructureFilter);
  annotation.joint.set(obstacle.joint);
  annotation.distance.set(obstacle.distance_m);
  annotation.share.set(obstacle.share);
  scene.scene().annotations.push_back(annotation);
}

/// Nothing is said of a piece that stands where the map has it as far as anything tells.
void annotate_furniture(const types::SceneCas& scene, const MovedFurniture& furniture) {
  for (size_t k = 0; k < furniture.pieces().size(); ++k) {
    const FurnitureState& state = furniture.states()[k];
    if (!state.moved && state.log_odds <= mapping::kFurnitureMotion.prior_log_odds) continue;
    const auto annotation = types::FurnitureAnnotation::create(scene.cas());
    annotation.source.set(kStructureFilter);
    annotation.name.set(state.name);
    annotation.links.set(furniture.pieces()[k].links);
    annotation.moved.set(state.moved);
    annotation.found.set(state.found);
    annotation.shift_x.set(state.shift.x());
    annotation.shift_y.set(state.shift.y());
    annotation.turn.set(state.turn);
    annotation.motion.set(types::to(scene.cas(), furniture.motion(k)));
    annotation.log_odds.set(state.log_odds);
    annotation.confidence.set(probability_from_log_odds(state.log_odds));
    scene.scene().annotations.push_back(annotation);
  }
}

}  // namespace

void KnownStructureOptions::declare(OptionTable& table) {
  table.texts("regions", regions, "Links or classes of the map that support objects; * and ? are wildcards.");
  table.number(
      "epsilon_m", epsilon_m, "m",
      "Maximum distance in front of a map surface for a point to be explained by it (plus the depth noise).",
      0, 1);
  table.number("region_height_m", region_height_m, "m", "Height of the region of interest above a support.",
               0.01, 5);
  table.number("support_tolerance_m", support_tolerance_m, "m",
               "Points closer than this to the height of a support belong to its region of interest.", 0,
               0.2);
  table.number("margin_m", margin_m, "m",
               "Distance by which a region of interest extends beyond the edge of its support.", 0, 0.5);
}

KnownStructure find_known_structure(const cv::Mat& points, const cv::Mat& normals,
                                    const mapping::PinholeCamera& camera, const Isometry3d& map_from_camera,
                                    KnownMap& map, const std::vector<SupportSurface>& surfaces,
                                    const JointState& joints, const KnownStructureOptions& options,
                                    int threads) {
  KnownStructure result;
  map.scene.set_joints(map.part, joints);
  mapping::RenderOptions rendering;
  rendering.normals = !normals.empty();
  const mapping::RenderedView view = map.scene.render(camera, map_from_camera, rendering, threads);
  result.map_depth = view.depth;
  for (const SupportSurface& surface : surfaces)
    result.regions.push_back({&surface, map.scene.map_from_link(surface.link_id) * surface.link_from_top, 0,
                              height_over(surface, joints, options)});
  const std::vector<Prism> prisms = prisms_in_view(result.regions, camera, map_from_camera, options);
  std::vector<char> is_surface(map.scene.link_names().size(), 0);
  for (const SupportSurface& surface : surfaces) is_surface[surface.link_id] = 1;
  result.region = cv::Mat::zeros(points.size(), CV_16U);
  result.kind = cv::Mat::zeros(points.size(), CV_8U);
  result.bare = cv::Mat::zeros(points.size(), CV_8U);
  std::mutex counting;
  const auto classify = [&](size_t first_row, size_t end_row) {
    Counts counts(result.regions.size());
    auto* kind_of = result.kind.ptr<uint8_t>();
    auto* region_label = result.region.ptr<uint16_t>();
    const auto set = [&](int pixel, mapping::PixelKind kind, int region) {
      kind_of[pixel] = static_cast<uint8_t>(kind);
      region_label[pixel] = static_cast<uint16_t>(region + 1);
      if (kind == mapping::PixelKind::map_explained) ++counts.known;
      if (kind == mapping::PixelKind::background) ++counts.outside;
      if (kind == mapping::PixelKind::region_of_interest) ++counts.pixels[static_cast<size_t>(region)];
    };
    const auto* point = points.ptr<cv::Vec3f>();
    const auto* model_depth = view.depth.ptr<float>();
    const auto* model_link = view.link.ptr<int>();
    const int end = static_cast<int>(end_row) * points.cols;
    for (int i = static_cast<int>(first_row) * points.cols; i < end; ++i) {
      const int link = model_link[i];
      const bool by_surface = link >= 0 && is_surface[static_cast<size_t>(link)] != 0;
      if (by_surface || link < 0) result.bare.ptr<uint8_t>()[i] = 255;
      const auto z = static_cast<double>(point[i][2]);
      if (std::isnan(z)) continue;
      const double noise = 2 * depth_noise(z);
      const bool explained = static_cast<double>(model_depth[i]) - z <= options.epsilon_m + noise;
      if (explained && !by_surface) {  // Known, wherever it lies.
        set(i, mapping::PixelKind::map_explained, -1);
        continue;
      }
      double height = 0;
      const Vector3d p(static_cast<double>(point[i][0]), static_cast<double>(point[i][1]), z);
      const int region = region_of(p, prisms, options, height);
      const double tolerance = options.support_tolerance_m + noise;
      // Around the height of a surface the point belongs to it, even where the map has the surface lower; but
      // not the foot of the wall behind it.
      if (region >= 0 && (!explained || std::abs(height) <= tolerance))
        set(i, mapping::PixelKind::region_of_interest, region);
      else
        set(i, explained ? mapping::PixelKind::map_explained : mapping::PixelKind::background, -1);
    }
    const std::lock_guard lock(counting);
    result.known += counts.known;
    result.outside += counts.outside;
    for (size_t r = 0; r < counts.pixels.size(); ++r) result.regions[r].pixels += counts.pixels[r];
  };
  parallel_for(static_cast<size_t>(points.rows), threads, classify);
  if (!normals.empty()) grow_known_structure(points, normals, view, is_surface, options, result);
  return result;
}

AnnotatorDescriptor KnownStructureFilter::descriptor() const {
  return {kStructureFilter,
          "Removes map-explained points (walls, floor, sides of furniture) and keeps the regions of interest "
          "above supports.",
          {"Scene", "view:cloud", "view:normals", "CameraInfo"},
          {"RegionOfInterest", "SegmentationLocationAnnotation", "JointAnnotation", "ObstacleAnnotation",
           "FurnitureAnnotation", "view:regions", "view:structure", "view:map_depth", "view:bare"},
          {"JointState"},
          {"Scene", "JointState", "PlanarSupport"}};
}

void KnownStructureFilter::declare(OptionTable& table) {
  options_.declare(table);
  refinement_.declare(table);
  table.flag("fit_joints", fit_joints_,
             "Estimates joints of drawers and doors that the recording does not report, from their fronts.");
  table.flag("find_furniture", find_furniture_,
             "Finds furniture that is not where the map has it, and goes on with it where it stands.");
  table.text("camera_link", camera_link_,
             "Link of the robot that is the depth camera (optical frame); it places the robot in the map.");
}

void KnownStructureFilter::start(Context& context) {
  map_ = context.resources.find<KnownMap>();
  if (!map_ || !map_->has_geometry()) return;
  surfaces_ = map_->support_surfaces(options_.regions);
  if (surfaces_.empty())
    throw Error(fmt::format("no link of the map matches the regions {}", fmt::join(options_.regions, ", ")),
                {}, "name the links that objects stand on: KnownStructureFilter: {regions: [...]}");
  if (find_furniture_) {
    furniture_ = std::make_unique<MovedFurniture>(*map_, refinement_);
    if (const auto* known = context.resources.find<FurnitureStates>()) furniture_->restore(known->pieces);
  }
  fronts_ = std::make_unique<ArticulatedFronts>(map_->world, map_->meshes);
}

void KnownStructureFilter::finish(Context& context) {
  if (!furniture_) return;
  for (const std::string& text : furniture_->texts()) context.warnings.add(text);
  furniture_->reset();
}

void KnownStructureFilter::find_furniture(const types::SceneCas& scene, const FurnitureFrame& frame,
                                          int threads) {
  if (!furniture_) return;
  if (has_measured_pose(scene.scene()) && furniture_->update(frame, threads)) {
    fronts_ = std::make_unique<ArticulatedFronts>(map_->world, map_->meshes);
    for (const std::string& text : furniture_->texts()) scene.log(kStructureFilter, "info", text);
  }
  annotate_furniture(scene, *furniture_);
}

std::vector<SupportSurface> KnownStructureFilter::standing_surfaces() const {
  std::vector<SupportSurface> standing = surfaces_;
  for (size_t k = 0; furniture_ && k < furniture_->pieces().size(); ++k)
    if (!furniture_->states()[k].found)
      std::erase_if(standing, [&](const SupportSurface& surface) {
        return std::ranges::find(furniture_->pieces()[k].links, surface.link) !=
               furniture_->pieces()[k].links.end();
      });
  return standing;
}

/// The pose of the camera, fitted to the map; the scene is told when it moves.
Isometry3d KnownStructureFilter::refined_pose(const types::SceneCas& facade, const cv::Mat& points,
                                              const mapping::PinholeCamera& camera, Context& context) {
  const types::Scene scene = facade.scene();
  Isometry3d given = map_from_camera(scene);
  if (!refinement_.refine_pose || !has_measured_pose(scene)) return given;
  const PoseRefinement refinement =
      refine_pose(points, cloud_normals(facade), camera, given, map_->scene, refinement_, context.threads);
  facade.log(
      kStructureFilter, "info",
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
                                      const Context& context, JointState& joints) {
  if (!fit_joints_) return;
  const TimeNs time = scene.scene().timestamp.get();
  const bool in_video = context.in_video(time) || (last_fitted_ && time - *last_fitted_ < kSecond);
  last_fitted_ = time;
  JointState fitted = joints;
  for (FrontState& front : fronts_->estimate(points, camera, pose, joints, context.threads)) {
    if (!joints.contains(front.joint)) tracks_.settle(front, time, in_video);
    if (!front.determined) continue;
    annotate_joint(scene, front);
    if (joints.contains(front.joint)) continue;
    fitted[front.joint] = front.position;  // Also where it is assumed: that a drawer is shut again is seen.
    if (!front.moved) continue;
    scene.log(kStructureFilter, "info",
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
      find_known_structure(points, {}, camera, pose, *map_, {}, {}, options_, context.threads);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  points.setTo(cv::Scalar::all(static_cast<double>(nan)),
               known.kind == static_cast<int>(mapping::PixelKind::map_explained));
  cv::Mat normals = cloud_normals(facade).clone();
  normals.setTo(cv::Scalar::all(static_cast<double>(nan)),
                known.kind == static_cast<int>(mapping::PixelKind::map_explained));
  set_cloud_points(facade, points);
  set_cloud_normals(facade, normals);
  types::set_view_image(facade, kStructureView, known.kind);
  facade.log(kStructureFilter, "info", fmt::format("{} points on robots", known.known));
}

void KnownStructureFilter::annotate_obstacles(const types::SceneCas& scene, const cv::Mat& points,
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
    scene.log(kStructureFilter, "info",
              fmt::format("something stands {:.2f} m before {} and hides {:.0f} % of it", obstacle.distance_m,
                          obstacle.joint, 100 * obstacle.share));
  }
}

void KnownStructureFilter::process(cas::Cas& cas, Context& context) {
  const types::SceneCas facade(cas);
  const types::Scene scene = facade.scene();
  if (!map_) {
    facade.log(kStructureFilter, "info", "no map: nothing is known, nothing is removed");
    return;
  }
  const mapping::PinholeCamera camera = types::cameras(facade).depth;
  if (!map_->has_geometry()) {
    remove_robots(facade, camera, context);
    return;
  }
  if (!scene.map_from_camera.is_set()) {
    facade.log(kStructureFilter, "warning", "without a pose the map cannot be compared");
    return;
  }
  const JointState all_joints = joints_of(scene, *map_, context.warnings);
  JointState joints = joints_of_world(map_->world, all_joints);
  map_->scene.set_joints(map_->part, joints);
  map_->hide_robots();
  const cv::Mat points = cloud_points(facade);
  const Isometry3d pose = refined_pose(facade, points, camera, context);
  const cv::Mat normals = cloud_normals(facade);
  find_furniture(facade, {points, normals, camera, pose, joints}, context.threads);
  fit_joints(facade, points, camera, pose, context, joints);
  map_->place_robots(scene.timestamp.get(), all_joints, camera_link_, pose);
  const std::vector<SupportSurface> surfaces = standing_surfaces();
  KnownStructure known =
      find_known_structure(points, normals, camera, pose, *map_, surfaces, joints, options_, context.threads);
  annotate_obstacles(facade, points, camera, pose, joints, known.map_depth);
  // Regions out of view are left out, the others numbered from 1 in the order of the scene's supports.
  std::vector<uint16_t> number(known.regions.size() + 1, 0);
  uint16_t next = 0;
  for (size_t r = 0; r < known.regions.size(); ++r)
    if (known.regions[r].pixels >= kFewPixels) number[r + 1] = ++next;
  auto* label = known.region.ptr<uint16_t>();
  for (int i = 0; i < points.rows * points.cols; ++i) label[i] = number[label[i]];
  for (size_t r = 0; r < known.regions.size(); ++r)
    if (number[r + 1] > 0) add_region(facade, known.regions[r], known.region, number[r + 1]);
  types::set_view_image(facade, kRegionsView, known.region);
  types::set_view_image(facade, kStructureView, known.kind);
  types::set_view_image(facade, kMapDepthView, known.map_depth);
  types::set_view_image(facade, kBareView, known.bare);
  facade.log(
      kStructureFilter, "info",
      fmt::format("{} points known, {} in no region, {} regions in view", known.known, known.outside, next));
}

}  // namespace loci::perception
