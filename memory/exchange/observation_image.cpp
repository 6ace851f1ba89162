#include "memory/exchange/observation_image.h"

#include <algorithm>
#include <cmath>

#include "mapping/base/error.h"
#include "mapping/image/image_io.h"
#include "memory/store/scene_images.h"

namespace loci::memory {
namespace {

cv::Mat image_in(const Store& store, Id blob) {
  const std::string bytes = store.blob(blob).bytes;
  return mapping::decode_image({bytes.begin(), bytes.end()}, store.name());
}

}  // namespace

cv::Mat mask_of(const Store& store, const SceneRow& scene, const ObservationRow& observation) {
  if (!scene.camera || !observation.roi) return {};
  cv::Mat mask = cv::Mat::zeros(scene.camera->height, scene.camera->width, CV_8U);
  const auto& [x, y, width, height] = *observation.roi;
  const cv::Rect roi = cv::Rect(x, y, width, height) & cv::Rect(0, 0, mask.cols, mask.rows);
  if (roi.empty()) return {};
  const cv::Mat own = observation.mask ? image_in(store, *observation.mask) : cv::Mat();
  if (own.size() == roi.size() && own.type() == CV_8U)
    own.copyTo(mask(roi));
  else
    mask(roi) = 255;
  return mask;
}

cv::Mat label_image(const Store& store, const SceneRow& scene, const AsOf& as_of) {
  cv::Mat labels;
  for (const AssociationRow& association : store.associations(scene.id, as_of)) {
    if (!association.chosen || !association.object || !association.observation ||
        association.probability <= 0)
      continue;
    if (*association.object > 65535)
      throw Error(object_name(*association.object) + " has no number in a label image", {store.name(), 0, {}},
                  "16 bits are enough for 65535 objects");
    const cv::Mat mask = mask_of(store, scene, store.observation(*association.observation));
    if (mask.empty()) continue;
    if (labels.empty()) labels = cv::Mat::zeros(mask.size(), CV_16U);
    labels.setTo(static_cast<int>(*association.object), mask);
  }
  return labels;
}

namespace {

/// The points of the depth thumbnail under the mask, and their pixels in the depth image.
ClusterPoints coarse_points(const Store& store, const SceneRow& scene, const ObservationRow& observation) {
  ClusterPoints cluster;
  const std::optional<DepthThumbnail> depth = DepthThumbnail::of(store, scene);
  const cv::Mat mask = depth ? mask_of(store, scene, observation) : cv::Mat();
  if (mask.empty()) return cluster;
  const SceneCamera& camera = *scene.camera;
  for (int y = 0; y < depth->height(); ++y)
    for (int x = 0; x < depth->width(); ++x) {
      const double z = static_cast<double>(depth->depth()[static_cast<size_t>(y * depth->width() + x)]);
      // Pixel centres are at integers, so edges are at -0.5 and scale with the image.
      const double u = (x + 0.5) * camera.width / depth->width() - 0.5,
                   v = (y + 0.5) * camera.height / depth->height() - 0.5;
      const int column = std::min(mask.cols - 1, static_cast<int>(std::lround(u))),
                row = std::min(mask.rows - 1, static_cast<int>(std::lround(v)));
      if (!(z > 0) || mask.at<uint8_t>(row, column) == 0) continue;
      cluster.pixels.push_back(row * mask.cols + column);
      cluster.points.push_back(
          Vector3d((u - camera.cx) / camera.fx * z, (v - camera.cy) / camera.fy * z, z).cast<float>());
    }
  return cluster;
}

}  // namespace

ClusterPoints measured_points(const Store& store, const SceneRow& scene, const ObservationRow& observation) {
  if (std::optional<ClusterPoints> stored = cluster_points(store, scene, observation))
    return *std::move(stored);
  return coarse_points(store, scene, observation);
}

std::optional<mapping::Scan> cloud_of(const Store& store, const SceneRow& scene,
                                      const ObservationRow& observation) {
  if (!scene.camera || !scene.map_from_camera) return std::nullopt;
  const ClusterPoints cluster = measured_points(store, scene, observation);
  if (cluster.points.empty()) return std::nullopt;
  const cv::Mat image = scene.image ? image_in(store, *scene.image) : cv::Mat();
  const Eigen::Isometry3f map_from_camera = scene.map_from_camera->cast<float>();
  mapping::Scan cloud;
  cloud.name = "scene_" + std::to_string(scene.id);
  cloud.origins = {map_from_camera.translation()};
  for (size_t i = 0; i < cluster.points.size(); ++i) {
    mapping::ScanPoint point{.position = map_from_camera * cluster.points[i]};
    if (image.type() == CV_8UC3) {
      const int row = cluster.pixels[i] / scene.camera->width,
                column = cluster.pixels[i] % scene.camera->width;
      const auto& color = image.at<cv::Vec3b>(row * image.rows / scene.camera->height,
                                              column * image.cols / scene.camera->width);
      point.b = color[0];
      point.g = color[1];
      point.r = color[2];
    }
    cloud.points.push_back(point);
  }
  return cloud;
}

}  // namespace loci::memory
