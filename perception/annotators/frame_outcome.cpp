#include "perception/annotators/frame_outcome.h"

#include <algorithm>
#include <array>

#include "mapping/sensor/pixel_kind.h"
#include "perception/annotators/io/labelled_recording.h"
#include "perception/annotators/scene_data.h"
#include "perception/annotators/segmentation/clustering/plane_cluster_extractor.h"
#include "perception/annotators/structure/known_structure.h"
#include "perception/annotators/structure/supports.h"
#include "perception/conversions/opencv.h"

namespace loci::perception {
namespace {

constexpr double kMinShare = 0.02;  ///< of an image, for anything to be found in it

double share(const cv::Mat& mask) {
  return static_cast<double>(cv::countNonZero(mask)) / static_cast<double>(std::max<size_t>(1, mask.total()));
}

/// Share of pixels with a number in all channels.
double finite_share(const cv::Mat& vectors) {
  cv::Mat first;
  cv::extractChannel(vectors, first, 0);
  return share(first == first);  // NaN differs from itself
}

/// Whether there is a support when the camera is taken as turned by quarters of a circle about its axis.
bool shows_support(const cv::Mat& points, const cv::Mat& normals, const mapping::PinholeCamera& camera,
                   int quarters) {
  static constexpr std::array<std::array<float, 4>, 4> kTurns = {
      {{1, 0, 0, 1}, {0, 1, -1, 0}, {-1, 0, 0, -1}, {0, -1, 1, 0}}};
  const auto& [a, b, c, d] = kTurns[static_cast<size_t>(quarters)];
  const cv::Matx33f turn(a, b, 0, c, d, 0, 0, 0, 1);
  cv::Mat turned_points, turned_normals;
  cv::transform(points, turned_points, turn);
  cv::transform(normals, turned_normals, turn);
  return !find_supports(turned_points, turned_normals, camera, std::nullopt, SupportOptions()).empty();
}

std::optional<Reason> no_depth_because(const cv::Mat& depth) {
  if (cv::countNonZero(depth > 0) == 0) return Reason::no_depth;
  if (share((depth > 0.2) & (depth < 5.0)) < kMinShare) return Reason::no_depth_in_range;
  return std::nullopt;
}

/// What an annotator logged about the scene.
std::vector<types::LogEntry> log_of(const types::SceneCas& scene, const std::string& annotator) {
  std::vector<types::LogEntry> entries;
  if (!scene.scene().log.is_set()) return entries;
  for (const types::LogEntry& entry : scene.scene().log.get().entries)
    if (entry.annotator.get() == annotator) entries.push_back(entry);
  return entries;
}

/// What the reader of the recording could not read of it; empty where nothing was wrong.
std::string damage_of(const types::SceneCas& scene) {
  for (const types::LogEntry& entry : log_of(scene, "RecordingReader"))
    if (entry.level.get() == "error") return entry.text.get();
  return {};
}

Reason no_object_in_map_because(const types::SceneCas& scene) {
  const cv::Mat map_depth = types::view_image(scene, kMapDepthView);
  if (share(map_depth == map_depth) < kMinShare) return Reason::outside_map;
  if (scene.supports().empty()) return Reason::no_support_in_view;
  const cv::Mat kind = types::view_image(scene, kStructureView);
  const bool over_supports =
      share(kind == static_cast<int>(mapping::PixelKind::region_of_interest)) >= kMinShare;
  return over_supports ? Reason::support_empty : Reason::map_explained;
}

}  // namespace

Reason no_support_because(const cv::Mat& depth, const cv::Mat& points, const cv::Mat& normals,
                          const mapping::PinholeCamera& camera, const std::optional<Vector3d>& up) {
  if (const auto reason = no_depth_because(depth)) return *reason;
  if (finite_share(normals) < kMinShare) return Reason::depth_too_sparse;
  if (up) {
    // A camera that looks ahead or down, upright, is right about what is up: a plane across is a wall.
    const bool looks_up = up->z() > 0.5, is_turned = up->y() > -0.3;
    const bool tilted = (looks_up || is_turned) && shows_support(points, normals, camera, 0);
    return tilted ? Reason::map_not_level : Reason::no_plane;
  }
  for (const int quarters : {1, 2, 3})
    if (shows_support(points, normals, camera, quarters)) return Reason::camera_rolled;
  return Reason::no_plane;
}

std::optional<Reason> no_object_because(const types::SceneCas& scene, bool remembers) {
  if (!scene.clusters().empty()) {
    if (!remembers) return std::nullopt;
    const std::vector<int> numbers = tracked_numbers(scene);
    const bool known = std::ranges::any_of(numbers, [](int number) { return number > 0; });
    return known ? std::nullopt : std::optional(Reason::unconfirmed);
  }
  if (!scene.scene().map_from_camera.is_set()) return Reason::no_pose;
  const cv::Mat depth = types::view_image(scene, types::SceneCas::kDepth);
  if (const auto reason = no_depth_because(depth)) return damage_of(scene).empty() ? reason : Reason::damaged;
  if (log_of(scene, PlaneClusterExtractor::kName).empty()) return Reason::nothing_new;
  if (scene.has(kMapDepthView)) return no_object_in_map_because(scene);
  if (!scene.supports().empty()) return Reason::support_empty;
  std::optional<Vector3d> up;
  if (has_measured_pose(scene.scene()))
    up = map_from_camera(scene.scene()).linear().transpose() * Vector3d::UnitZ();
  return no_support_because(depth, cloud_points(scene), cloud_normals(scene), types::cameras(scene).depth,
                            up);
}

}  // namespace loci::perception
