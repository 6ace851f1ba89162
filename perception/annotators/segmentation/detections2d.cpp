#include "perception/annotators/segmentation/detections2d.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>

#include "mapping/base/text/text.h"
#include "mapping/recording/recording.h"
#include "perception/annotators/scene_data.h"
#include "perception/annotators/segmentation/clustering/plane_cluster_extractor.h"
#include "perception/annotators/structure/known_structure.h"
#include "perception/annotators/structure/supports.h"
#include "perception/conversions/opencv.h"
#include "perception/detection/lift.h"

namespace loci::perception {
namespace {

constexpr double kSurface_m = 0.008;  ///< thickness of what counts as the surface of a support, beside noise
constexpr double kSame = 0.5;         ///< shared part of the pixels of each from which on both are one object

/// A support and where it is in the image.
struct VisibleSupport {
  types::PlanarSupport support;
  cv::Mat inside;  ///< CV_8U, 255 = over its outline
};

std::vector<VisibleSupport> visible_supports(const types::SceneCas& scene, const Isometry3d& pose,
                                             const mapping::PinholeCamera& camera) {
  std::vector<VisibleSupport> visible;
  for (const types::PlanarSupport& support : scene.supports())
    visible.push_back({support, pixels_over(support, pose.inverse(), camera)});
  return visible;
}

/// The surfaces of the supports themselves, CV_8U, 255.
cv::Mat surfaces_of(const std::vector<VisibleSupport>& supports, const cv::Mat& points,
                    const Isometry3d& pose) {
  cv::Mat surfaces = cv::Mat::zeros(points.size(), CV_8U);
  for (const VisibleSupport& visible : supports) {
    const auto [normal, offset] = plane_in_camera(visible.support, pose);
    for (int i = 0; i < static_cast<int>(points.total()); ++i) {
      const Vector3d point = to_vector(points.ptr<cv::Vec3f>()[i]);
      if (visible.inside.data[i] != 0 &&
          std::abs(normal.dot(point) - offset) < kSurface_m + 3 * depth_noise(point.z()))
        surfaces.data[i] = 255;
    }
  }
  return surfaces;
}

/// What no detection can be of, CV_8U, 255: the surfaces of supports, and what the map explains.
cv::Mat explained_in(const types::SceneCas& scene, const std::vector<VisibleSupport>& supports,
                     const cv::Mat& points, const Isometry3d& pose) {
  const cv::Mat surfaces = surfaces_of(supports, points, pose);
  if (!scene.has(kStructureView)) return surfaces;
  constexpr auto kExplained = static_cast<int>(mapping::PixelKind::map_explained);
  return surfaces | (types::view_image(scene, kStructureView) == kExplained);
}

/// The support that most of the pixels are over; null without any.
types::PlanarSupport support_of(const std::vector<int>& pixels, const std::vector<VisibleSupport>& supports) {
  types::PlanarSupport best;
  std::ptrdiff_t most = 0;
  for (const VisibleSupport& visible : supports) {
    const auto count =
        std::ranges::count_if(pixels, [&](int pixel) { return visible.inside.data[pixel] != 0; });
    if (count <= most) continue;
    most = count;
    best = visible.support;
  }
  return best;
}

size_t common_pixels(const std::vector<int>& one, const std::vector<int>& two) {
  std::vector<int> common;
  std::ranges::set_intersection(one, two, std::back_inserter(common));
  return common.size();
}

/// The cluster that shows the object of a detection: it lies in the region, and the object in it. What was
/// lifted alone does not decide: of flat objects the lowest part, which a box leaves out, is half of them.
std::optional<types::Cluster> cluster_with(const std::vector<int>& lifted, const std::vector<int>& region,
                                           const types::SceneCas& scene) {
  for (const types::Cluster& cluster : scene.clusters()) {
    const cas::Buffer<int32_t> buffer = cluster_indices(cluster);
    std::vector<int> indices(buffer.begin(), buffer.end());
    std::ranges::sort(indices);
    const auto half_of = [&](const std::vector<int>& whole, const std::vector<int>& other) {
      return static_cast<double>(common_pixels(whole, other)) >= kSame * static_cast<double>(whole.size());
    };
    if (half_of(lifted, indices) && half_of(indices, region)) return cluster;
  }
  return std::nullopt;
}

types::Cluster make_cluster(const LiftedRegion& lifted, const std::string& source,
                            const std::vector<VisibleSupport>& supports, const types::SceneCas& scene,
                            const Isometry3d& pose) {
  const auto cluster = types::Cluster::create(scene.cas());
  set_points(cluster, source, lifted.pixels, scene, pose);
  cluster.at_image_border.set(lifted.at_image_border);
  if (const types::PlanarSupport support = support_of(lifted.pixels, supports)) cluster.support.set(support);
  if (scene.has(types::SceneCas::kColor)) {
    const cv::Mat color = types::view_image(scene, types::SceneCas::kColor);
    add_image(cluster, source,
              color_region(cloud_points(scene), lifted.pixels, types::cameras(scene), color.size()), scene);
  }
  scene.add_cluster(cluster);
  return cluster;
}

void classify(const types::Cluster& cluster, const std::string& source, const Detection2D& detection) {
  if (detection.classes.empty()) return;
  const auto annotation = types::ClassificationAnnotation::create(cluster.cas());
  annotation.source.set(source);
  annotation.kind.set("object");
  annotation.label.set(detection.classes.front().first);
  annotation.confidence.set(detection.classes.front().second);
  cluster.annotations.push_back(annotation);
}

/// A warning that names images with detections that no frame has, if others are in the recording.
void warn_of_foreign_images(const DetectionSet& set, const mapping::Recording& recording,
                            const std::string& file, Warnings& warnings) {
  std::set<const ImageDetections*> known;
  for (size_t i = 0; i < recording.size(); ++i)
    known.insert(set.find(recording.name_of(i), recording.index_of(i), recording.time_of(i)));
  std::vector<std::string> foreign;
  for (const ImageDetections& image : set.images())
    if (!image.detections.empty() && !known.contains(&image)) foreign.push_back(image.image);
  if (foreign.empty() || foreign.size() == set.images().size()) return;
  const size_t count = foreign.size();
  constexpr size_t kNamed = 3;
  if (count > kNamed) foreign.resize(kNamed);
  warnings.add(fmt::format("{} with detections in no frame of the recording: {}{}", counted(count, "image"),
                           joined(foreign, ", "), count > kNamed ? ", …" : ""),
               {file, 0, {}});
}

}  // namespace

AnnotatorDescriptor Detections2D::descriptor() const {
  AnnotatorDescriptor descriptor{
      kName,
      "Makes clusters with classes of what another detector found in the colour images (COCO, YOLO, JSON "
      "Lines).",
      {"Scene", "CameraInfo", "view:cloud"},
      {"Cluster", "ReferenceClusterPoints", "StandaloneImageROI", "ClassificationAnnotation"},
      {"view:color", "view:structure", "PlanarSupport", "Cluster"}};
  descriptor.needs_options = true;
  return descriptor;
}

void Detections2D::declare(OptionTable& table) {
  table.text("detections", path_,
             "COCO file (*.json), JSON Lines (*.jsonl), or folder with a YOLO text file per image.");
}

void Detections2D::start(Context& context) {
  if (path_.empty())
    throw Error("Detections2D has no detections", {},
                "give `detections: FILE`, a COCO file, JSON Lines or a YOLO folder");
  set_ = DetectionSet::read(path_, context.warnings);
  if (const auto* recording = context.resources.find<mapping::Recording>())
    warn_of_foreign_images(*set_, *recording, path_, context.warnings);
}

void Detections2D::process(cas::Cas& cas, Context& /*context*/) {
  const types::Scene scene = types::SceneCas(cas).scene();
  if (const ImageDetections* found =
          set_->find(scene.frame_name.get(), scene.frame_index.get(), scene.timestamp.get()))
    add_detections(cas, found->detections, kName, lifted_);
}

void Detections2D::finish(Context& context) {
  if (lifted_.total() == 0)
    context.warnings.add("no frame has detections: their images are matched to frames by name",
                         {path_, 0, {}});
  else
    warn_of_unlifted(lifted_, path_, context.warnings);
}

void add_detections(cas::Cas& cas, const std::vector<Detection2D>& detections, const std::string& source,
                    Tally& lifted_detections) {
  if (detections.empty()) return;
  const types::SceneCas facade(cas);
  const types::Scene scene = facade.scene();
  if (!scene.map_from_camera.is_set()) return lifted_detections.add(Reason::no_pose, detections.size());
  const Isometry3d pose = map_from_camera(scene);
  const mapping::RgbdCamera camera = types::cameras(facade);
  const cv::Mat points = cloud_points(facade);
  const std::vector<VisibleSupport> supports = visible_supports(facade, pose, camera.depth);
  const Vector3d up = pose.linear().transpose() * Vector3d::UnitZ();
  const LiftFrame frame =
      lift_frame_of_points(points, camera, explained_in(facade, supports, points, pose), up);
  for (const Detection2D& detection : detections) {
    const LiftResult lifted = lift_region(frame, detection.region);
    if (!lifted.region) {
      lifted_detections.add(lifted.reason);
      continue;
    }
    lifted_detections.add_used();
    const std::optional<types::Cluster> known =
        cluster_with(lifted.region->pixels, pixels_in(frame, detection.region), facade);
    classify(known ? *known : make_cluster(*lifted.region, source, supports, facade, pose), source,
             detection);
  }
}

void warn_of_unlifted(const Tally& lifted_detections, const std::string& file, Warnings& warnings) {
  if (const std::string reasons = lifted_detections.reasons(); !reasons.empty())
    warnings.add(fmt::format("{} of {} were not lifted to 3-D: {}",
                             lifted_detections.total() - lifted_detections.used(),
                             counted(lifted_detections.total(), "detection"), reasons),
                 {file, 0, {}});
}

}  // namespace loci::perception
