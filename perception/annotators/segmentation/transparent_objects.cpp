#include "perception/annotators/segmentation/transparent_objects.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "perception/annotators/scene_data.h"
#include "perception/annotators/segmentation/clustering/plane_cluster_extractor.h"
#include "perception/annotators/structure/supports.h"
#include "perception/conversions/opencv.h"

namespace loci::perception {
namespace {

constexpr double kMaxShadow = 0.3;  ///< of a hole's rows
constexpr int kBorder = 8;          ///< Kinects measure nothing at the edges of their images

/// Where a pixel's ray meets the surface.
Vector3d on_surface(const mapping::PinholeCamera& camera, const HoleSurface& surface, double u, double v) {
  const Vector3d ray = camera.unproject(u, v, 1);
  return surface.offset / surface.normal.dot(ray) * ray;
}

/// Height over `foot` at which an upright line comes nearest to a pixel's ray.
double height_over(const Vector3d& foot, const Vector3d& up, const Vector3d& ray) {
  const double along = up.dot(ray), length = ray.squaredNorm();
  return (along * foot.dot(ray) - length * foot.dot(up)) / (length - along * along);
}

/// Which share of what is measured around a hole is the surface.
double surface_around(const cv::Mat& hole, const cv::Rect& box, const cv::Mat& depth,
                      const mapping::PinholeCamera& camera, const HoleSurface& surface, double tolerance) {
  cv::Mat ring;
  cv::dilate(hole, ring, cv::Mat::ones(7, 7, CV_8U));
  int all = 0;
  int on = 0;
  for (int v = 0; v < box.height; ++v)
    for (int u = 0; u < box.width; ++u) {
      if (!ring.at<unsigned char>(v, u) || hole.at<unsigned char>(v, u)) continue;
      const cv::Point at(u + box.x, v + box.y);
      const auto z = static_cast<double>(depth.at<float>(at));
      if (!(z > 0)) continue;
      ++all;
      const double height = surface.normal.dot(camera.unproject(at.x, at.y, z)) - surface.offset;
      on += surface.inside.at<unsigned char>(at) && !surface.taken.at<unsigned char>(at) &&
                    std::abs(height) < tolerance
                ? 1
                : 0;
    }
  return all == 0 ? 0 : static_cast<double>(on) / all;
}

/// Which share of a hole's rows a sensor whose projector stands beside its camera leaves by itself: the
/// shadow of what is nearer on one side of the row falls on what is farther on the other.
double shadow_share(const cv::Mat& hole, const cv::Rect& box, const cv::Mat& depth,
                    const mapping::PinholeCamera& camera, double baseline_m) {
  constexpr double kSlack = 4;  // Edges are ragged.
  constexpr int kNear = 6;
  int rows = 0;
  int shadows = 0;
  for (int v = 0; v < box.height; ++v) {
    int first = box.width;
    int last = -1;
    for (int u = 0; u < box.width; ++u)
      if (hole.at<unsigned char>(v, u)) {
        first = std::min(first, u);
        last = u;
      }
    if (last < 0) continue;
    ++rows;
    // The nearest measurement that is within some pixels beside the hole.
    const auto beside = [&](int u, int step) {
      double inverse = 0;
      for (int k = 1; k <= kNear; ++k) {
        const int column = u + box.x + step * k;
        if (column < 0 || column >= depth.cols) break;
        const auto z = static_cast<double>(depth.at<float>(v + box.y, column));
        if (z > 0) inverse = std::max(inverse, 1 / z);
      }
      return inverse;
    };
    const double width = camera.fx * baseline_m * std::abs(beside(first, -1) - beside(last, 1));
    shadows += last - first + 1 <= width + kSlack && width > kSlack ? 1 : 0;
  }
  return rows == 0 ? 0 : static_cast<double>(shadows) / rows;
}

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
  add_image(cluster, TransparentExtractor::kName,
            color_region(points, candidate.pixels, camera, color.size()), scene);
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
  box.source.set(TransparentExtractor::kName);
  box.tf_frame.set(scene.scene().map_from_camera.get().frame_id.get());
  box.bbox.get_or_create().pose.set(types::to(cas, map_from_object));
  box.bbox.get().size.set(types::to(cas, size));
  cluster.hypotheses.push_back(box);
  const auto geometry = types::GeometryAnnotation::create(cas);
  geometry.source.set(TransparentExtractor::kName);
  geometry.map_from_object.set(types::to(cas, map_from_object));
  geometry.size.set(types::to(cas, size));
  geometry.height.set(candidate.height);
  geometry.place_from_object.set(types::to(cas, Isometry3d(map_from_support.inverse() * map_from_object)));
  if (support.name.is_set()) geometry.place.set(support.name.get());
  cluster.annotations.push_back(geometry);
  const auto material = types::ClassificationAnnotation::create(cas);
  material.source.set(TransparentExtractor::kName);
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

void TransparentOptions::declare(OptionTable& table) {
  table.number("min_width_m", min_width_m, "m", "Minimum width of a candidate.", 0.005, 1);
  table.number("max_width_m", max_width_m, "m", "Maximum width of a candidate.", 0.01, 2);
  table.number("min_height_m", min_height_m, "m", "Minimum height of a candidate.", 0.005, 1);
  table.number("max_height_m", max_height_m, "m", "Maximum height of a candidate.", 0.01, 2);
  table.number("surrounded", surrounded, "",
               "Minimum share of the support surface among the pixels around a hole.", 0, 1);
  table.number("baseline_m", baseline_m, "m", "Baseline between projector and camera, which causes shadows.",
               0, 1);
  table.number("surface_m", surface_m, "m", "Maximum distance of points of the surface from its plane.",
               0.001, 0.1);
}

std::vector<TransparentCandidate> find_transparent(const cv::Mat& depth, const mapping::PinholeCamera& camera,
                                                   const HoleSurface& surface,
                                                   const TransparentOptions& options) {
  cv::Mat holes = ~(depth > 0) & surface.inside & ~surface.taken;
  // Single pixels that were measured through the glass do not part it, single ones that were not are no hole.
  cv::morphologyEx(holes, holes, cv::MORPH_CLOSE, cv::Mat::ones(5, 5, CV_8U));
  cv::morphologyEx(holes, holes, cv::MORPH_OPEN, cv::Mat::ones(5, 5, CV_8U));
  cv::Mat labels;
  cv::Mat stats;
  cv::Mat centres;
  const int count = cv::connectedComponentsWithStats(holes, labels, stats, centres, 8);
  const cv::Rect image({0, 0}, depth.size());
  std::vector<TransparentCandidate> found;
  for (int label = 1; label < count; ++label) {
    const cv::Rect own(stats.at<int>(label, cv::CC_STAT_LEFT), stats.at<int>(label, cv::CC_STAT_TOP),
                       stats.at<int>(label, cv::CC_STAT_WIDTH), stats.at<int>(label, cv::CC_STAT_HEIGHT));
    const cv::Rect box(own.x - kBorder, own.y - kBorder, own.width + 2 * kBorder, own.height + 2 * kBorder);
    if ((box & image) != box) continue;
    TransparentCandidate candidate;
    const double middle = own.x + 0.5 * (own.width - 1);
    const Vector3d front = on_surface(camera, surface, middle, own.y + own.height - 1);
    candidate.width = own.width * front.z() / camera.fx;
    if (candidate.width < options.min_width_m || candidate.width > options.max_width_m) continue;
    // What is seen first of a foot is its front.
    const Vector3d ahead = (front - surface.normal.dot(front) * surface.normal).normalized();
    candidate.foot = front + 0.5 * candidate.width * ahead;
    // The uppermost pixel shows the far side of its rim.
    candidate.height =
        height_over(front + candidate.width * ahead, surface.normal, camera.unproject(middle, own.y, 1));
    if (candidate.height < options.min_height_m || candidate.height > options.max_height_m) continue;
    const cv::Mat hole = labels(box) == label;
    candidate.surrounded = surface_around(hole, box, depth, camera, surface, options.surface_m);
    if (candidate.surrounded < options.surrounded) continue;
    if (shadow_share(hole, box, depth, camera, options.baseline_m) > kMaxShadow) continue;
    for (int v = 0; v < box.height; ++v)
      for (int u = 0; u < box.width; ++u)
        if (hole.at<unsigned char>(v, u)) candidate.pixels.push_back((v + box.y) * depth.cols + u + box.x);
    found.push_back(std::move(candidate));
  }
  return found;
}

AnnotatorDescriptor TransparentExtractor::descriptor() const {
  return {
      TransparentExtractor::kName,
      "Adds candidates for transparent objects at holes in the depth image that have the size of a glass.",
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
  scene.log(TransparentExtractor::kName, "info", fmt::format("{} transparent candidates", found));
}

}  // namespace loci::perception
