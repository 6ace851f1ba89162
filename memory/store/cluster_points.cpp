#include "memory/store/cluster_points.h"

#include <cmath>

#include "mapping/image/image_io.h"

namespace loci::memory {

std::optional<ClusterPoints> cluster_points(const Store& store, const SceneRow& scene,
                                            const ObservationRow& observation) {
  if (!observation.cloud || !observation.mask || !observation.roi || !scene.camera) return std::nullopt;
  const std::string packed = store.blob(*observation.mask).bytes;
  const cv::Mat mask = mapping::decode_image({packed.begin(), packed.end()}, store.path().string());
  const std::vector<float> depth = decode_cluster_depth(store.blob(*observation.cloud).bytes);
  const SceneCamera& camera = *scene.camera;
  const auto& [left, top, width, height] = *observation.roi;
  ClusterPoints cluster;
  size_t next = 0;
  for (int y = 0; y < mask.rows; ++y)
    for (int x = 0; x < mask.cols; ++x) {
      if (mask.at<uint8_t>(y, x) == 0) continue;
      const float z = next < depth.size() ? depth[next] : 0;
      ++next;
      if (!(z > 0)) continue;
      const int u = left + x, v = top + y;
      cluster.pixels.push_back(v * camera.width + u);
      cluster.points.emplace_back(static_cast<float>((u - camera.cx) / camera.fx) * z,
                                  static_cast<float>((v - camera.cy) / camera.fy) * z, z);
    }
  if (next != depth.size() || mask.cols != width || mask.rows != height)
    throw Error("the points of observation " + std::to_string(observation.id) + " are not those of its mask",
                {store.path().string(), 0, {}});
  return cluster;
}

std::string encode_cluster_depth(std::span<const float> depth) {
  // Neighbours differ little: the high bytes are nearly all alike, which the database's compression likes.
  std::string low, high;
  uint16_t before = 0;
  for (const float z : depth) {
    const double millimetres = z > 0 ? std::round(1000.0 * static_cast<double>(z)) : 0;
    const auto value = static_cast<uint16_t>(millimetres > 65535 ? 0 : millimetres);
    const auto change = static_cast<int16_t>(static_cast<uint16_t>(value - before));
    // Zigzag: small changes of either sign are small numbers.
    const auto code = static_cast<uint16_t>(change < 0 ? -2 * change - 1 : 2 * change);
    low.push_back(static_cast<char>(code & 0xff));
    high.push_back(static_cast<char>(code >> 8));
    before = value;
  }
  return low + high;
}

std::vector<float> decode_cluster_depth(std::string_view bytes) {
  std::vector<float> depth(bytes.size() / 2);
  uint16_t value = 0;
  for (size_t i = 0; i < depth.size(); ++i) {
    const auto code = static_cast<uint16_t>(static_cast<unsigned char>(bytes[i]) |
                                            static_cast<unsigned char>(bytes[depth.size() + i]) << 8);
    const int change = (code & 1) != 0 ? -(code / 2) - 1 : code / 2;
    value = static_cast<uint16_t>(value + change);
    depth[i] = static_cast<float>(value) / 1000.0F;
  }
  return depth;
}

}  // namespace loci::memory
