#include "perception/annotators/hypotheses/known_structure_filter.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "perception/annotators/scene_data.h"
#include "perception/conversions/camera.h"
#include "perception/conversions/opencv.h"

namespace loci {
namespace {

constexpr int kFewPixels = 200;  ///< A region with fewer is not in view.

JointState joints_of(const types::Scene& scene, const World& world, Warnings& warnings) {
  JointState joints;
  if (!scene.joint_state.is_set()) return joints;
  const types::JointState state = scene.joint_state.get();
  const std::vector<std::string> names = state.names.to_vector();
  const std::vector<double> positions = state.positions.to_vector();
  for (size_t i = 0; i < std::min(names.size(), positions.size()); ++i) {
    if (world.find_joint(names[i]))
      joints[names[i]] = positions[i];
    else
      warnings.add("the map has no joint '" + names[i] + "', which the recording moves");
  }
  return joints;
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

}  // namespace

AnnotatorDescriptor KnownStructureFilter::descriptor() const {
  return {"KnownStructureFilter",
          "Removes what the map explains (walls, floor, sides of furniture) and keeps the regions above "
          "supports.",
          {"Scene", "view:cloud", "CameraInfo"},
          {"RegionOfInterest", "SegmentationLocationAnnotation", "view:regions", "view:map_depth"}};
}

void KnownStructureFilter::start(Context& context) {
  map_ = context.resources.find<KnownMap>();
  if (!map_) return;
  surfaces_ = map_->support_surfaces(options_.regions);
  if (surfaces_.empty())
    throw Error(fmt::format("no link of the map matches the regions {}", fmt::join(options_.regions, ", ")),
                {}, "name the links that objects stand on: KnownStructureFilter: {regions: [...]}");
}

void KnownStructureFilter::process(cas::Cas& cas, Context& context) {
  const types::SceneCas facade(cas);
  const types::Scene scene = facade.scene();
  if (!map_) {
    facade.log("KnownStructureFilter", "info", "no map: nothing is known, nothing is removed");
    return;
  }
  if (!scene.map_from_camera.is_set()) {
    facade.log("KnownStructureFilter", "warning", "without a pose the map cannot be compared");
    return;
  }
  KnownStructure known = find_known_structure(
      cloud_points(facade), types::cameras(facade).depth, map_from_camera(scene), *map_, surfaces_,
      joints_of(scene, map_->world, context.warnings), options_, context.threads);
  // Regions out of view are left out, the others numbered from 1 in the order of the scene's supports.
  std::vector<uint16_t> number(known.regions.size() + 1, 0);
  uint16_t next = 0;
  for (size_t r = 0; r < known.regions.size(); ++r)
    if (known.regions[r].pixels >= kFewPixels) number[r + 1] = ++next;
  for (size_t i = 0; i < known.region.total(); ++i) {
    uint16_t& label = known.region.ptr<uint16_t>()[i];
    label = number[label];
  }
  for (size_t r = 0; r < known.regions.size(); ++r)
    if (number[r + 1] > 0) add_region(facade, known.regions[r], known.region, number[r + 1], options_);
  types::set_view_image(facade, kRegionsView, known.region);
  types::set_view_image(facade, kMapDepthView, known.map_depth);
  facade.log(
      "KnownStructureFilter", "info",
      fmt::format("{} points known, {} in no region, {} regions in view", known.known, known.outside, next));
}

}  // namespace loci
