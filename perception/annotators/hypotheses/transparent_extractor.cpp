#include "perception/annotators/hypotheses/transparent_extractor.h"

#include <fmt/format.h>

#include "perception/annotators/hypotheses/cluster_parts.h"
#include "perception/annotators/hypotheses/support_pixels.h"
#include "perception/annotators/scene_data.h"
#include "perception/conversions/camera.h"
#include "perception/conversions/opencv.h"

namespace loci::perception {
namespace {

constexpr const char* kName = "TransparentExtractor";

/// Where it would stand: upright, turned as its place is.
Isometry3d map_from_box(const TransparentCandidate& candidate, const Vector3d& foot,
                        const Isometry3d& map_from_support) {
  Isometry3d pose = map_from_support;
  pose.translation() = foot + 0.5 * candidate.height * map_from_support.linear().col(2);
  return pose;
}

/// The hole in the colour image, as if it were as far away as the foot.
void image_candidate(const TransparentCandidate& candidate, const types::Cluster& cluster,
                     const types::SceneCas& scene, const mapping::RgbdCamera& camera) {
  if (!scene.has(types::SceneCas::kColor)) return;
  const cv::Mat color = types::view_image(scene, types::SceneCas::kColor);
  cv::Mat points(camera.depth.height, camera.depth.width, CV_32FC3);
  for (const int pixel : candidate.pixels) {
    const Vector3d p = camera.depth.unproject(pixel % points.cols, pixel / points.cols, candidate.foot.z());
    points.ptr<cv::Vec3f>()[pixel] = {static_cast<float>(p.x()), static_cast<float>(p.y()),
                                      static_cast<float>(p.z())};
  }
  add_image(cluster, kName, color_region(points, candidate.pixels, camera, color.size()), scene);
}

void add_cluster(const TransparentCandidate& candidate, const types::PlanarSupport& support,
                 const types::SceneCas& scene, const Isometry3d& pose, const mapping::RgbdCamera& camera) {
  cas::Cas& cas = scene.cas();
  const Isometry3d map_from_support = types::from<Isometry3d>(support.map_from_support.get());
  const Isometry3d map_from_object = map_from_box(candidate, pose * candidate.foot, map_from_support);
  const Vector3d size(candidate.width, candidate.width, candidate.height);
  const auto cluster = types::Cluster::create(cas);
  image_candidate(candidate, cluster, scene, camera);
  const auto box = types::TFLinkBBoxROI::create(cas);
  box.source.set(kName);
  box.tf_frame.set(scene.scene().map_from_camera.get().frame_id.get());
  box.bbox.get_or_create().pose.set(types::to(cas, map_from_object));
  box.bbox.get().size.set(types::to(cas, size));
  cluster.hypotheses.push_back(box);
  const auto geometry = types::GeometryAnnotation::create(cas);
  geometry.source.set(kName);
  geometry.map_from_object.set(types::to(cas, map_from_object));
  geometry.size.set(types::to(cas, size));
  geometry.height.set(candidate.height);
  geometry.place_from_object.set(types::to(cas, Isometry3d(map_from_support.inverse() * map_from_object)));
  if (support.name.is_set()) geometry.place.set(support.name.get());
  cluster.annotations.push_back(geometry);
  const auto material = types::ClassificationAnnotation::create(cas);
  material.source.set(kName);
  material.kind.set("material");
  material.label.set("transparent");
  material.confidence.set(candidate.surrounded);
  cluster.annotations.push_back(material);
  cluster.centroid.set(types::to(cas, Vector3d(map_from_object.translation())));
  cluster.at_image_border.set(false);
  cluster.at_support_border.set(false);
  cluster.partly_hidden.set(false);
  cluster.support.set(support);
  scene.add_cluster(cluster);
}

}  // namespace

AnnotatorDescriptor TransparentExtractor::descriptor() const {
  return {
      kName,
      "Makes holes in depth that are as large as a glass candidates for something transparent.",
      {"Scene", "CameraInfo", "view:depth", "PlanarSupport"},
      {"Cluster", "StandaloneImageROI", "TFLinkBBoxROI", "GeometryAnnotation", "ClassificationAnnotation"},
      {"Cluster", "ReferenceClusterPoints", "view:color"}};
}

void TransparentExtractor::declare(OptionTable& table) {
  options_.declare(table);
}

void TransparentExtractor::process(cas::Cas& cas, Context& /*context*/) {
  constexpr int kMargin = 2;
  const types::SceneCas scene(cas);
  if (!scene.scene().map_from_camera.is_set()) return;
  const Isometry3d pose = map_from_camera(scene.scene());
  const mapping::RgbdCamera camera = types::cameras(scene);
  const cv::Mat depth = types::view_image(scene, types::SceneCas::kDepth);
  cv::Mat taken = pixels_of_clusters(scene, depth.size(), kMargin);
  size_t found = 0;
  for (const types::PlanarSupport& support : scene.supports()) {
    const auto [normal, offset] = plane_in_camera(support, pose);
    const HoleSurface surface = {normal, offset, pixels_over(support, pose.inverse(), camera.depth), taken};
    for (const TransparentCandidate& candidate : find_transparent(depth, camera.depth, surface, options_)) {
      add_cluster(candidate, support, scene, pose, camera);
      // Of two supports that overlap in the image one has it.
      for (const int pixel : candidate.pixels) taken.ptr<unsigned char>()[pixel] = 255;
      ++found;
    }
  }
  scene.log(kName, "info", fmt::format("{} transparent candidates", found));
}

}  // namespace loci::perception
