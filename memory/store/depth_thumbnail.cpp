#include "memory/store/depth_thumbnail.h"

#include <array>
#include <cmath>

namespace loci::memory {

std::optional<DepthThumbnail> DepthThumbnail::of(const Store& store, const SceneRow& scene) {
  if (!scene.depth || !scene.camera || !scene.map_from_camera) return std::nullopt;
  const std::vector<float> depth = decode_depth_thumbnail(store.blob(*scene.depth).bytes);
  const int64_t pixels = int64_t{scene.depth_width} * scene.depth_height;
  if (pixels <= 0 || static_cast<int64_t>(depth.size()) != pixels)
    throw Error("the depth thumbnail of scene " + std::to_string(scene.id) + " has another size than it says",
                {store.path().string(), 0, {}});
  return DepthThumbnail(*scene.camera, *scene.map_from_camera, scene.depth_width, scene.depth_height, depth);
}

const char* to_text(SpotStatus status) {
  constexpr std::array kNames = {"unknown", "out_of_view", "hidden", "seen", "seen_empty", "no_depth"};
  return kNames.at(static_cast<size_t>(status));
}

DepthThumbnail::DepthThumbnail(SceneCamera camera, Isometry3d map_from_camera, int width, int height,
                               std::vector<float> depth)
    : camera_(std::move(camera)),
      camera_from_map_(map_from_camera.inverse()),
      width_(width),
      height_(height),
      depth_(std::move(depth)) {
  // Pixel centres are at integers, so edges are at -0.5 and scale with the image.
  const double sx = static_cast<double>(width) / camera_.width,
               sy = static_cast<double>(height) / camera_.height;
  camera_.fx *= sx;
  camera_.fy *= sy;
  camera_.cx = (camera_.cx + 0.5) * sx - 0.5;
  camera_.cy = (camera_.cy + 0.5) * sy - 0.5;
}

SpotStatus DepthThumbnail::spot_status(const Vector3d& point, double tolerance_m) const {
  const Vector3d p = camera_from_map_ * point;
  if (p.z() <= camera_.range_min.value_or(0.05) || p.z() > camera_.range_max.value_or(20))
    return SpotStatus::out_of_view;
  const long u = std::lround(camera_.fx * p.x() / p.z() + camera_.cx);
  const long v = std::lround(camera_.fy * p.y() / p.z() + camera_.cy);
  if (u < 0 || v < 0 || u >= width_ || v >= height_) return SpotStatus::out_of_view;
  // A pixel beside an edge may belong to either side: the neighbours are asked too.
  bool measured = false, there = false, behind = false;
  for (long y = std::max(0L, v - 1); y <= std::min<long>(height_ - 1, v + 1); ++y)
    for (long x = std::max(0L, u - 1); x <= std::min<long>(width_ - 1, u + 1); ++x) {
      const float z = depth_[static_cast<size_t>(y * width_ + x)];
      if (!(z > 0)) continue;
      measured = true;
      if (std::abs(z - p.z()) <= tolerance_m) there = true;
      if (z > p.z() + tolerance_m) behind = true;
    }
  if (!measured) return SpotStatus::no_depth;
  if (there) return SpotStatus::seen;
  return behind ? SpotStatus::seen_empty : SpotStatus::hidden;
}

std::string encode_depth_thumbnail(const std::vector<float>& depth) {
  std::string bytes;
  bytes.reserve(2 * depth.size());
  for (const float z : depth) {
    const double millimetres = z > 0 ? std::round(1000.0 * static_cast<double>(z)) : 0;
    const auto value = static_cast<uint16_t>(millimetres > 65535 ? 0 : millimetres);
    bytes.push_back(static_cast<char>(value & 0xff));
    bytes.push_back(static_cast<char>(value >> 8));
  }
  return bytes;
}

std::vector<float> decode_depth_thumbnail(std::string_view bytes) {
  std::vector<float> depth(bytes.size() / 2);
  for (size_t i = 0; i < depth.size(); ++i) {
    const auto low = static_cast<unsigned char>(bytes[2 * i]),
               high = static_cast<unsigned char>(bytes[2 * i + 1]);
    depth[i] = static_cast<float>(low | high << 8) / 1000.0F;
  }
  return depth;
}

}  // namespace loci::memory
