#include "perception/annotators/segmentation/asserted_volumes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <sstream>

#include "perception/annotators/scene_data.h"
#include "perception/conversions/hypotheses.h"

namespace loci::perception {
namespace {

types::TFLinkROI make_roi(cas::Cas& cas, const AssertedVolume& volume) {
  const Vector3d centre(volume.numbers[0], volume.numbers[1], volume.numbers[2]);
  if (volume.numbers.size() == 4) {
    const auto sphere = types::TFLinkSphereROI::create(cas);
    sphere.source.set(AssertedVolumes::kName);
    sphere.tf_frame.set(volume.frame);
    sphere.center.set(types::to(cas, centre));
    sphere.radius.set(volume.numbers[3]);
    return sphere;
  }
  Isometry3d pose = Isometry3d::Identity();
  pose.translation() = centre;
  const auto box = types::TFLinkBBoxROI::create(cas);
  box.source.set(AssertedVolumes::kName);
  box.tf_frame.set(volume.frame);
  box.bbox.get_or_create().pose.set(types::to(cas, pose));
  box.bbox.get().size.set(types::to(cas, Vector3d(volume.numbers[3], volume.numbers[4], volume.numbers[5])));
  return box;
}

/// Where the frame of a volume is; nothing when the scene does not have it.
std::optional<Isometry3d> map_from_frame(const types::SceneCas& scene, const std::string& frame) {
  if (frame == scene.scene().map_from_camera.get().frame_id.get()) return Isometry3d::Identity();
  for (const types::PlanarSupport& support : scene.supports())
    if (support.name.get() == frame && support.map_from_support.is_set())
      return types::from<Isometry3d>(support.map_from_support.get());
  return std::nullopt;
}

/// Those of the points that are no part of any support.
std::vector<int32_t> above_supports(const types::SceneCas& scene, const std::vector<int32_t>& indices,
                                    const Isometry3d& pose, double above) {
  const cv::Mat points = cloud_points(scene);
  const std::vector<types::PlanarSupport> supports = scene.supports();
  std::vector<int32_t> result;
  for (const int32_t index : indices) {
    const cv::Vec3f& point = points.ptr<cv::Vec3f>()[index];
    const Vector3d p = pose * to_vector(point);
    const bool in_support = std::any_of(supports.begin(), supports.end(), [&](const auto& support) {
      const auto normal = types::from<Vector3d>(support.normal.get());
      return std::abs(normal.dot(p) - support.offset.get()) <= above;
    });
    if (!in_support) result.push_back(index);
  }
  return result;
}

/// Common points over the points of the smaller set.
double shared(const std::vector<int32_t>& a, std::vector<int32_t> b) {
  std::sort(b.begin(), b.end());
  std::vector<int32_t> both;
  std::set_intersection(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(both));
  const size_t smaller = std::min(a.size(), b.size());
  return smaller == 0 ? 0 : static_cast<double>(both.size()) / static_cast<double>(smaller);
}

/// The cluster that shares most with some points; nothing below `least`.
std::optional<types::Cluster> cluster_like(const types::SceneCas& scene, const std::vector<int32_t>& indices,
                                           double least) {
  std::optional<types::Cluster> best;
  for (const types::Cluster& cluster : scene.clusters()) {
    const auto own = cluster_indices(cluster);
    const double share = shared(indices, {own.begin(), own.end()});
    if (share < least) continue;
    least = share;
    best = cluster;
  }
  return best;
}

}  // namespace

AssertedVolume AssertedVolume::parse(const std::string& text) {
  AssertedVolume volume;
  std::istringstream stream(text);
  stream >> volume.frame;
  for (double number = 0; stream >> number;) volume.numbers.push_back(number);
  const size_t count = volume.numbers.size();
  const bool positive = count > 3 && std::all_of(volume.numbers.begin() + 3, volume.numbers.end(),
                                                 [](double extent) { return extent > 0; });
  if (!stream.eof() || (count != 4 && count != 6) || !positive)
    throw Error(
        fmt::format("'{}' is no volume", text), {},
        "a frame with x y z radius or x y z and three extents, in metres: 'table_1 0.2 0.1 0.05 0.1'");
  return volume;
}

AnnotatorDescriptor AssertedVolumes::descriptor() const {
  return {AssertedVolumes::kName,
          "Adds externally asserted volumes as hypotheses to the clusters found there, or as new clusters.",
          {"Scene", "view:cloud"},
          {"Cluster", "ReferenceClusterPoints", "TFLinkROI"},
          {"Cluster", "PlanarSupport"},
          {"Cluster"}};
}

void AssertedVolumes::declare(OptionTable& table) {
  table.texts(
      "volumes", texts_,
      "Each 'FRAME x y z radius' or 'FRAME x y z dx dy dz' in metres; FRAME is the map frame or a support.");
  table.number("above_m", above_m_, "m", "Points closer than this to a support belong to it.", 0, 0.2);
  table.number("overlap", overlap_, "",
               "Minimum share of common points for a volume to be assigned to an existing cluster.", 0, 1);
  table.integer("min_points", min_points_, "px", "Minimum size of a new cluster.", 1, 100000);
}

void AssertedVolumes::start(Context& /*context*/) {
  volumes_.clear();
  for (const std::string& text : texts_) volumes_.push_back(AssertedVolume::parse(text));
}

void AssertedVolumes::process(cas::Cas& cas, Context& /*context*/) {
  const types::SceneCas scene(cas);
  if (!scene.scene().map_from_camera.is_set()) return;
  const Isometry3d pose = map_from_camera(scene.scene());
  for (const AssertedVolume& volume : volumes_) {
    const auto frame = map_from_frame(scene, volume.frame);
    if (!frame) continue;  // Its place is not in this scene.
    const types::TFLinkROI roi = make_roi(cas, volume);
    const auto inside = types::points_in_volume(roi, scene.cloud(), frame->inverse() * pose);
    const auto all = inside.indices.get().indices.get();
    const std::vector<int32_t> indices = above_supports(scene, {all.begin(), all.end()}, pose, above_m_);
    if (const auto known = cluster_like(scene, indices, overlap_)) {
      known->hypotheses.push_back(roi);
      continue;
    }
    if (static_cast<int>(indices.size()) < min_points_) {
      scene.log(AssertedVolumes::kName, "info",
                fmt::format("nothing is seen in a volume of {}", volume.frame));
      continue;
    }
    inside.indices.get().indices.set(indices);
    const auto cluster = types::Cluster::create(cas);
    cluster.hypotheses.push_back(inside);
    cluster.hypotheses.push_back(roi);
    Vector3d sum = Vector3d::Zero();
    const std::vector<Vector3d> positions = types::positions_of(inside);
    for (const Vector3d& position : positions) sum += position;
    cluster.centroid.set(types::to(cas, Vector3d(pose * (sum / static_cast<double>(positions.size())))));
    scene.add_cluster(cluster);
  }
}

}  // namespace loci::perception
