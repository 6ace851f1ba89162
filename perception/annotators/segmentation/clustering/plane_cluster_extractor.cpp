#include "perception/annotators/segmentation/clustering/plane_cluster_extractor.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "mapping/base/math/math.h"
#include "perception/annotators/scene_data.h"
#include "perception/conversions/opencv.h"

namespace loci::perception {
namespace {

/// By how much a map's surface may be off in height where nothing of it is measured.
constexpr double kMapHeightError = 0.015;
/// What is smaller may be a plate or a tray rather than the support.
constexpr double kMinSupportArea = 0.1;  ///< m²
/// In a frame named "map" the floor is at z = 0 (docs/file-formats.md).
constexpr double kFloorHeight = 0.15;

/// The plane of a region of interest as the map has it, but for `raised` metres.
SupportPlane plane_of_map(const Isometry3d& camera_from_support, double raised, double uncertainty) {
  SupportPlane plane;
  plane.normal = camera_from_support.linear().col(2);
  plane.offset = plane.normal.dot(camera_from_support.translation()) + raised;
  plane.camera_from_plane = Eigen::Translation3d(raised * plane.normal) * camera_from_support;
  plane.uncertainty = uncertainty;
  return plane;
}

/// The plane that fits what is measured of a region near where the map has it. Unset where that is too
/// little.
std::optional<SupportPlane> measured_plane(const SupportPlane& in_map, const Isometry3d& camera_from_support,
                                           const cv::Mat& points, const cv::Mat& normals,
                                           const std::vector<int>& region, const SupportOptions& options) {
  constexpr float kNear = 0.05f, kLevel = 0.9f;
  constexpr size_t kMinLevel = 100;
  const Eigen::Vector3f up = in_map.normal.cast<float>();
  const cv::Vec3f n(up.x(), up.y(), up.z());
  const auto along = [&n](const cv::Vec3f& v) { return n[0] * v[0] + n[1] * v[1] + n[2] * v[2]; };
  const auto* point = points.ptr<cv::Vec3f>();
  const auto* direction = normals.ptr<cv::Vec3f>();
  std::vector<int> pixels, level;
  std::vector<float> heights;
  for (const int i : region) {
    const float height = along(point[i]) - static_cast<float>(in_map.offset);
    if (std::abs(height) > kNear) continue;
    pixels.push_back(i);
    if (!(along(direction[i]) > kLevel)) continue;
    level.push_back(i);
    heights.push_back(height);
  }
  if (level.size() <= kMinLevel) return std::nullopt;
  const auto raised = static_cast<double>(median(std::move(heights)));
  std::optional<SupportPlane> plane =
      refine_support(points, normals, pixels, in_map.normal, in_map.offset + raised, options);
  // A fit to few points may tilt away from what the map says; one to a strip and a plate behind it does.
  constexpr double kMinCosine = 0.985, kTilted = 0.99985, kMinShare = 0.85;
  const double cosine = plane ? plane->normal.dot(in_map.normal) : 0;
  if (cosine < kMinCosine) return std::nullopt;
  const auto explained = [&](const SupportPlane& by) {
    return static_cast<int>(std::ranges::count_if(level, [&](int i) {
      return std::abs(by.normal.dot(to_vector(point[i])) - by.offset) < options.inlier_m;
    }));
  };
  SupportPlane upright = plane_of_map(camera_from_support, raised, 0);
  upright.inliers = explained(upright);
  if (cosine < kTilted && upright.inliers > kMinShare * explained(*plane)) return upright;
  return plane;
}

/// The surface of a region of interest as this frame shows it, or as the map has it where the frame shows too
/// little (glossy counters).
SupportPlane support_of_region(const types::PlanarSupport& known, int label, const cv::Mat& points,
                               const cv::Mat& normals, const std::vector<int>& region, const Isometry3d& pose,
                               const SupportOptions& options) {
  const Isometry3d camera_from_map = pose.inverse();
  const Isometry3d map_from_support = types::from<Isometry3d>(known.map_from_support.get());
  const Isometry3d camera_from_support = camera_from_map * map_from_support;
  const std::vector<Vector3d> corners = types::points_from_values(known.outline.get());
  std::vector<cv::Point2f> outline;
  for (const Vector3d& corner : corners) {
    const Eigen::Vector3f at = (map_from_support.inverse() * corner).cast<float>();
    outline.emplace_back(at.x(), at.y());
  }
  constexpr double kMinShare = 0.3;
  SupportOptions small = options;
  small.min_area_m2 = std::min(kMinSupportArea, kMinShare * cv::contourArea(outline));
  SupportPlane plane = plane_of_map(camera_from_support, 0, kMapHeightError);
  if (auto measured = measured_plane(plane, camera_from_support, points, normals, region, small))
    plane = std::move(*measured);
  plane.region = label;
  plane.in_drawer = known.support_class.get().starts_with("drawer");
  plane.outline.clear();
  for (const Vector3d& corner : corners)
    plane.outline.push_back(plane.in_plane(camera_from_map * corner).head<2>());
  return plane;
}

/// The pixels of each label of an image (CV_16U) from 1 to `count`, ascending.
std::vector<std::vector<int>> pixels_of_labels(const cv::Mat& labels, size_t count) {
  std::vector<std::vector<int>> pixels(count);
  const auto* label_of = labels.ptr<uint16_t>();
  for (int i = 0; i < labels.rows * labels.cols; ++i)
    if (label_of[i] > 0 && label_of[i] <= count) pixels[label_of[i] - 1U].push_back(i);
  return pixels;
}

/// Share of the outline that the image shows: in view, and not hidden behind something that does not stand
/// there.
double covered_fraction(const SupportPlane& plane, const cv::Mat& points,
                        const mapping::PinholeCamera& camera) {
  Eigen::AlignedBox2d extent;
  for (const Vector2d& corner : plane.outline) extent.extend(corner);
  const PolygonOutline outline(plane.outline);
  int all = 0;
  int seen = 0;
  constexpr double kStep = 0.03;
  for (double x = extent.min().x() + kStep / 2; x < extent.max().x(); x += kStep)
    for (double y = extent.min().y() + kStep / 2; y < extent.max().y(); y += kStep) {
      if (outline.inside({x, y}) < 0) continue;
      ++all;
      const Vector3d p = plane.camera_from_plane * Vector3d(x, y, 0);
      if (p.z() < 0.1) continue;
      const Vector2d pixel = camera.project(p);
      if (!camera.contains(pixel)) continue;
      const float z = points.at<cv::Vec3f>(static_cast<int>(std::lround(pixel.y())),
                                           static_cast<int>(std::lround(pixel.x())))[2];
      seen += std::abs(static_cast<double>(z) - p.z()) < 0.03 + 2 * depth_noise(p.z()) ? 1 : 0;
    }
  return all == 0 ? 0 : static_cast<double>(seen) / all;
}

/// Frame of a place that the map does not know: z along the normal, x as near as may be to the map's.
Isometry3d place_frame(const Vector3d& normal, const std::vector<Vector3d>& outline) {
  Eigen::AlignedBox3d extent;
  for (const Vector3d& corner : outline) extent.extend(corner);
  Isometry3d frame = Isometry3d::Identity();
  const Vector3d x = (Vector3d::UnitX() - normal * normal.x()).normalized();
  frame.linear().col(0) = x;
  frame.linear().col(1) = normal.cross(x);
  frame.linear().col(2) = normal;
  frame.translation() = extent.center();
  return frame;
}

void describe_support(const SupportPlane& plane, const Isometry3d& pose, double covered,
                      const types::PlanarSupport& support) {
  cas::Cas& cas = support.cas();
  const Vector3d normal = pose.linear() * plane.normal;
  const Vector3d centre = pose * plane.camera_from_plane.translation();
  support.normal.set(types::to(cas, normal));
  support.offset.set(normal.dot(centre));
  support.inliers.set(plane.inliers);
  support.covered_fraction.set(covered);
  if (support.map_from_support.is_set()) {
    // A place of the map keeps its frame; its height is what was measured, below the frame's origin.
    const Vector3d origin = types::from<Isometry3d>(support.map_from_support.get()).translation();
    support.height.set(origin.z() + (normal.dot(centre) - normal.dot(origin)) / normal.z());
    return;
  }
  std::vector<Vector3d> outline;
  for (const Vector2d& corner : plane.outline)
    outline.push_back(pose * (plane.camera_from_plane * Vector3d(corner.x(), corner.y(), 0)));
  support.height.set(centre.z());
  support.outline.set(types::values_from_points(outline));
  support.map_from_support.set(types::to(cas, place_frame(normal, outline)));
}

/// Height of the box over a drawer's bottom (m), 0 while it is shut; unset for other supports.
std::optional<double> drawer_height(const types::Scene& scene, const types::PlanarSupport& support) {
  if (!support.support_class.get().starts_with("drawer")) return std::nullopt;
  for (const types::RegionOfInterest& region : scene.regions)
    if (region.name.get() == support.name.get())
      return types::from<Vector3d>(region.bbox.get().size.get()).z();
  return std::nullopt;
}

/// How high the lowest of an object's points are over a plane, but for stray ones, metres.
double lowest_height(const ObjectCluster& object, const SupportPlane& plane, const cv::Mat& points) {
  constexpr double kStray = 0.02;
  std::vector<double> heights;
  for (const int pixel : object.pixels)
    heights.push_back(plane.in_plane(to_vector(points.ptr<cv::Vec3f>()[pixel])).z());
  const auto low = heights.begin() + static_cast<std::ptrdiff_t>(kStray * double(heights.size()));
  std::ranges::nth_element(heights, low);
  return *low;
}

/// What stands over a drawer but not in it: a place that has no name, level with the object's lowest points.
types::PlanarSupport unknown_support(const types::PlanarSupport& below, double height) {
  cas::Cas& cas = below.cas();
  const auto support = types::PlanarSupport::create(cas);
  const Vector3d normal = types::from<Vector3d>(below.normal.get());
  support.normal.set(types::to(cas, normal));
  support.offset.set(below.offset.get() + height);
  support.height.set(below.height.get() + height / normal.z());
  support.map_from_support.set(
      types::to(cas, Isometry3d(Eigen::Translation3d(height * normal) *
                                types::from<Isometry3d>(below.map_from_support.get()))));
  return support;
}

types::Cluster make_cluster(const ObjectCluster& found, const types::SceneCas& scene, const cv::Mat& points,
                            const Isometry3d& pose) {
  cas::Cas& cas = scene.cas();
  const auto cluster = types::Cluster::create(cas);
  set_points(cluster, PlaneClusterExtractor::kName, found.pixels, scene, pose);
  cluster.at_image_border.set(found.at_image_border);
  cluster.at_support_border.set(found.at_region_border);
  cluster.partly_hidden.set(found.partly_hidden);
  if (!scene.has(types::SceneCas::kColor)) return cluster;
  const cv::Mat color = types::view_image(scene, types::SceneCas::kColor);
  add_image(cluster, PlaneClusterExtractor::kName,
            color_region(points, found.pixels, types::cameras(scene), color.size()), scene);
  return cluster;
}

}  // namespace

ColorRegion color_region(const cv::Mat& points, const std::vector<int>& pixels,
                         const mapping::RgbdCamera& camera, const cv::Size& size) {
  const Isometry3d color_from_depth = camera.depth_from_color.inverse();
  // A depth pixel covers this many colour pixels, more where the colour image is larger.
  const double scale = camera.color.fx / camera.depth.fx * size.width / std::max(1, camera.color.width);
  const int spread = std::max(0, static_cast<int>(std::ceil((scale - 1.0) / 2)));
  std::vector<cv::Point> hits;
  hits.reserve(pixels.size());
  cv::Rect box;
  const cv::Rect image({0, 0}, size);
  for (const int pixel : pixels) {
    const cv::Vec3f& p = points.ptr<cv::Vec3f>()[pixel];
    const Vector3d in_color = color_from_depth * to_vector(p);
    if (!(in_color.z() > 0)) continue;
    const Vector2d at = camera.color.project(in_color);
    const cv::Point hit(static_cast<int>(std::lround(at.x())), static_cast<int>(std::lround(at.y())));
    if (!image.contains(hit)) continue;
    hits.push_back(hit);
    const cv::Rect one(hit, cv::Size(1, 1));
    box = box.empty() ? one : (box | one);
  }
  if (box.empty()) return {};
  box = cv::Rect(box.x - spread, box.y - spread, box.width + 2 * spread, box.height + 2 * spread) & image;
  cv::Mat mask = cv::Mat::zeros(box.size(), CV_8U);
  for (const cv::Point& hit : hits) mask.at<unsigned char>(hit - box.tl()) = 255;
  if (spread > 0) cv::dilate(mask, mask, cv::Mat::ones(2 * spread + 1, 2 * spread + 1, CV_8U));
  cv::morphologyEx(mask, mask, cv::MORPH_CLOSE, cv::Mat::ones(3, 3, CV_8U));
  return {box, mask};
}

void set_points(const types::Cluster& cluster, const std::string& source, const std::vector<int>& pixels,
                const types::SceneCas& scene, const Isometry3d& pose) {
  const auto reference = types::ReferenceClusterPoints::create(scene.cas());
  reference.source.set(source);
  reference.cloud.set(scene.cloud());
  reference.indices.get_or_create().indices.set(std::vector<int32_t>(pixels.begin(), pixels.end()));
  cluster.hypotheses.push_back(reference);
  const cv::Mat points = cloud_points(scene);
  Vector3d sum = Vector3d::Zero();
  for (const int pixel : pixels) {
    const cv::Vec3f& p = points.ptr<cv::Vec3f>()[pixel];
    sum += to_vector(p);
  }
  cluster.centroid.set(types::to(scene.cas(), Vector3d(pose * (sum / static_cast<double>(pixels.size())))));
}

void add_image(const types::Cluster& cluster, const std::string& source, const ColorRegion& region,
               const types::SceneCas& scene) {
  if (region.box.empty()) return;
  cas::Cas& cas = scene.cas();
  const cv::Mat color = types::view_image(scene, types::SceneCas::kColor);
  const auto roi = types::StandaloneImageROI::create(cas);
  roi.source.set(source);
  roi.roi.set(types::to(cas, region.box));
  roi.mask.set(types::to(cas, region.mask));
  roi.image.set(types::to(cas, cv::Mat(color(region.box).clone())));
  cluster.hypotheses.push_back(roi);
}

AnnotatorDescriptor PlaneClusterExtractor::descriptor() const {
  return {PlaneClusterExtractor::kName,
          "Finds supporting planes and one cluster per object that stands on them.",
          {"Scene", "CameraInfo", "view:cloud", "view:normals"},
          {"PlanarSupport", "Cluster", "ReferenceClusterPoints", "StandaloneImageROI"},
          {"view:color", "view:regions", "view:map_depth", "RegionOfInterest"},
          {"PlanarSupport"}};
}

void PlaneClusterExtractor::declare(OptionTable& table) {
  support_options_.declare(table);
  cluster_options_.declare(table);
}

void PlaneClusterExtractor::process(cas::Cas& cas, Context& context) {
  const types::SceneCas facade(cas);
  const types::Scene scene = facade.scene();
  if (!scene.map_from_camera.is_set()) {
    facade.log(PlaneClusterExtractor::kName, "warning", "without a pose nothing can be placed in the map");
    return;
  }
  const Isometry3d pose = map_from_camera(scene);
  const mapping::PinholeCamera camera = types::cameras(facade).depth;
  const cv::Mat points = cloud_points(facade);
  const cv::Mat normals = cloud_normals(facade);
  cv::Mat region;
  const cv::Mat map_depth = facade.has(kMapDepthView) ? types::view_image(facade, kMapDepthView) : cv::Mat();
  std::vector<SupportPlane> planes;
  if (facade.has(kRegionsView)) {
    region = types::view_image(facade, kRegionsView);
    const std::vector<types::PlanarSupport> known = facade.supports();
    const std::vector<std::vector<int>> pixels = pixels_of_labels(region, known.size());
    for (size_t i = 0; i < known.size(); ++i)
      planes.push_back(support_of_region(known[i], static_cast<int>(i) + 1, points, normals, pixels[i], pose,
                                         support_options_));
  } else {
    std::optional<Vector3d> up;
    if (has_measured_pose(scene)) up = pose.linear().transpose() * Vector3d::UnitZ();
    planes = find_supports(points, normals, camera, up, support_options_);
    if (scene.map_from_camera.get().frame_id.get() == "map")
      std::erase_if(planes, [&](const SupportPlane& plane) {
        return (pose * plane.camera_from_plane.translation()).z() < kFloorHeight;
      });
    for (size_t i = 0; i < planes.size(); ++i) facade.add_support(types::PlanarSupport::create(cas));
  }
  const std::vector<types::PlanarSupport> supports = facade.supports();
  for (size_t i = 0; i < planes.size(); ++i)
    describe_support(planes[i], pose, covered_fraction(planes[i], points, camera), supports[i]);
  ClusterImages images{points, normals, region, map_depth};
  if (facade.has(types::SceneCas::kColor)) {
    images.color = types::view_image(facade, types::SceneCas::kColor);
    images.color_camera = types::cameras(facade).color;
    images.color_from_depth = types::cameras(facade).depth_from_color.inverse();
  }
  ClusterOptions options = cluster_options_;
  if (context.in_video(scene.timestamp.get())) options.min_clear_points = options.min_points;
  const std::vector<ObjectCluster> found = extract_clusters(images, camera, planes, options, context.threads);
  std::vector<types::Cluster> clusters;
  for (const ObjectCluster& each : found) {
    clusters.push_back(make_cluster(each, facade, points, pose));
    const auto number = static_cast<size_t>(each.support);
    const std::optional<double> inside = drawer_height(scene, supports[number]);
    const double lowest = inside ? lowest_height(each, planes[number], points) : 0;
    const bool outside = inside && (*inside <= 0 || lowest > *inside);
    clusters.back().support.set(outside ? unknown_support(supports[number], lowest) : supports[number]);
    facade.add_cluster(clusters.back());
  }
  for (size_t i = 0; i < found.size(); ++i)
    if (found[i].stands_on >= 0) clusters[i].stands_on.set(clusters[static_cast<size_t>(found[i].stands_on)]);
  facade.log(PlaneClusterExtractor::kName, "info",
             fmt::format("{} supports, {} clusters", planes.size(), clusters.size()));
}

}  // namespace loci::perception
