#include "memory/annotators/kept_of_cas.h"

#include <algorithm>

#include "memory/store/scene_images.h"
#include "perception/conversions/opencv.h"

namespace loci::memory {
namespace {

constexpr std::string_view kStructure = "structure";  ///< view of the known structure filter: kinds of pixels

std::vector<LogRow> log_of(const perception::types::Scene& scene) {
  std::vector<LogRow> lines;
  if (!scene.log.is_set()) return lines;
  for (const perception::types::LogEntry& entry : scene.log.get().entries) {
    LogRow line;
    line.annotator = entry.annotator.get();
    line.level = entry.level.get();
    line.text = entry.text.get();
    if (entry.milliseconds.is_set()) line.milliseconds = entry.milliseconds.get();
    if (line.milliseconds && line.text == "done") line.text.clear();
    lines.push_back(std::move(line));
  }
  return lines;
}

BlobRecord cloud_of(const perception::types::Cluster& cluster, const cv::Mat& depth) {
  const auto reference = cluster.hypotheses.first<perception::types::ReferenceClusterPoints>();
  if (!reference) return {};
  std::vector<int32_t> pixels = reference.indices.get().indices.to_vector();
  // The mask has them in this order, and each once.
  std::ranges::sort(pixels);
  const auto repeated = std::ranges::unique(pixels);
  pixels.erase(repeated.begin(), repeated.end());
  std::vector<float> values;
  values.reserve(pixels.size());
  for (const int32_t pixel : pixels)
    values.push_back(depth.at<float>(pixel / depth.cols, pixel % depth.cols));
  return {encode_cluster_depth(values), kClusterDepthMedia};
}

}  // namespace

void add_what_is_kept(const perception::types::SceneCas& scene, bool clouds, SceneRecord& record) {
  if (scene.has(kStructure)) record.kinds = perception::types::view_image(scene, kStructure);
  record.log = log_of(scene.scene());
  if (!clouds) return;
  // What the annotators saw, where the noise was taken out of it.
  const cv::Mat depth =
      perception::types::view_image(scene, scene.has(perception::types::SceneCas::kSmoothedDepth)
                                               ? perception::types::SceneCas::kSmoothedDepth
                                               : perception::types::SceneCas::kDepth);
  const std::vector<perception::types::Cluster> clusters = scene.clusters();
  for (size_t i = 0; i < std::min(clusters.size(), record.observations.size()); ++i)
    record.observations[i].cloud = cloud_of(clusters[i], depth);
}

}  // namespace loci::memory
