#include "perception/annotators/hypotheses/cluster_parts.h"

#include "perception/annotators/scene_data.h"
#include "perception/conversions/opencv.h"

namespace loci::perception {

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
    sum += Vector3d(static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2]));
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

}  // namespace loci::perception
