#include "memory/store/scene_images.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "mapping/image/image_io.h"
#include "perception/types/geometry.h"
#include "perception/types/scene_cas.h"

namespace loci::memory {
namespace {

/// z-depth in whole millimetres; 0 = none, or too far.
uint16_t millimetres(float z) {
  const double value = z > 0 ? std::round(1000.0 * static_cast<double>(z)) : 0;
  return static_cast<uint16_t>(value > 65535 ? 0 : value);
}

}  // namespace

std::optional<DepthThumbnail> DepthThumbnail::of(const Store& store, const SceneRow& scene) {
  if (!scene.depth || !scene.camera || !scene.map_from_camera) return std::nullopt;
  return DepthThumbnail(*scene.camera, *scene.map_from_camera, scene.depth_width, scene.depth_height,
                        depth_thumbnail(store, scene));
}

std::vector<float> depth_thumbnail(const Store& store, const SceneRow& scene) {
  if (!scene.depth) return {};
  std::vector<float> depth = decode_depth_thumbnail(store.blob(*scene.depth).bytes);
  const int64_t pixels = int64_t{scene.depth_width} * scene.depth_height;
  if (pixels <= 0 || static_cast<int64_t>(depth.size()) != pixels)
    throw store.error(
        fmt::format("the depth thumbnail of scene {} has another size than its row says", scene.id));
  return depth;
}

const char* to_text(SpotStatus status) {
  constexpr std::array kNames = {"unknown", "out_of_view", "hidden", "seen", "seen_empty", "no_depth"};
  return kNames.at(static_cast<size_t>(status));
}

DepthThumbnail::DepthThumbnail(const SceneCamera& camera, const Isometry3d& map_from_camera, int width,
                               int height, std::vector<float> depth)
    : camera_(camera),
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

mapping::PinholeCamera pinhole_of(const SceneCamera& camera) {
  return {camera.width, camera.height, camera.fx, camera.fy, camera.cx, camera.cy};
}

mapping::RgbdCamera cameras_of(const Store& store, const SceneRow& row) {
  mapping::RgbdCamera cameras;
  cameras.depth = pinhole_of(*row.camera);
  cameras.color = cameras.depth;
  for (const FeatureStructureRow& stored :
       store.feature_structures(row.id, std::string(perception::types::CameraInfo::kTypeName))) {
    perception::cas::Cas cas(perception::types::type_system());
    const perception::types::CameraInfo info(read_feature_structure(store, stored.id, cas));
    if (info.name.get() != "color") continue;
    cameras.color = {info.width.get(), info.height.get(), info.fx.get(),
                     info.fy.get(),    info.cx.get(),     info.cy.get()};
    if (const perception::types::Transform pose = info.depth_from_camera.get())
      cameras.depth_from_color = perception::types::from<Isometry3d>(pose);
  }
  return cameras;
}

void add_color_camera(FeatureStructureWriter& structures, const mapping::RgbdCamera& cameras) {
  if (cameras.color == cameras.depth && cameras.depth_from_color.isApprox(Isometry3d::Identity())) return;
  perception::cas::Cas cas(perception::types::type_system());
  const auto info = perception::types::CameraInfo::create(cas);
  info.name.set("color");
  info.width.set(cameras.color.width);
  info.height.set(cameras.color.height);
  info.fx.set(cameras.color.fx);
  info.fy.set(cameras.color.fy);
  info.cx.set(cameras.color.cx);
  info.cy.set(cameras.color.cy);
  info.depth_from_camera.set(perception::types::to(cas, cameras.depth_from_color));
  structures.add(info);
}

std::string encode_depth_thumbnail(const std::vector<float>& depth) {
  std::string bytes;
  bytes.reserve(2 * depth.size());
  for (const float z : depth) {
    const uint16_t value = millimetres(z);
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

std::optional<PixelKindImage> pixel_kinds(const Store& store, const SceneRow& scene) {
  if (!scene.pixel_kinds) return std::nullopt;
  const std::string bytes = store.blob(*scene.pixel_kinds).bytes;
  PixelKindImage kinds{scene.depth_width, scene.depth_height, {}};
  if (static_cast<int64_t>(bytes.size()) != int64_t{kinds.width} * kinds.height)
    throw store.error(fmt::format("the pixel kinds of scene {} have another size than its depth", scene.id));
  for (const char byte : bytes)
    kinds.pixels.push_back(
        static_cast<mapping::PixelKind>(std::clamp<int>(byte, 0, mapping::kPixelKinds - 1)));
  return kinds;
}

std::optional<ClusterPoints> cluster_points(const Store& store, const SceneRow& scene,
                                            const ObservationRow& observation) {
  if (!observation.cloud || !observation.mask || !observation.roi || !scene.camera) return std::nullopt;
  const std::string packed = store.blob(*observation.mask).bytes;
  const cv::Mat mask = mapping::decode_image({packed.begin(), packed.end()}, store.name());
  const std::vector<float> depth = decode_cluster_depth(store.blob(*observation.cloud).bytes);
  const SceneCamera& camera = *scene.camera;
  const auto& [left, top, width, height] = *observation.roi;
  if (mask.type() != CV_8U || mask.cols != width || mask.rows != height || left + width > camera.width ||
      top + height > camera.height)
    throw store.error(
        fmt::format("the mask of observation {} does not lie in its depth image", observation.id));
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
  if (next != depth.size())
    throw store.error(fmt::format("the points of observation {} do not fit its mask", observation.id));
  return cluster;
}

std::string encode_cluster_depth(std::span<const float> depth) {
  // Neighbours differ little: the high bytes are nearly all alike, which the database's compression likes.
  std::string low, high;
  uint16_t before = 0;
  for (const float z : depth) {
    const uint16_t value = millimetres(z);
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
