#pragma once

#include <optional>

#include "memory/store/store.h"

namespace loci::memory {

/// What a scene reports about a spot.
enum class SpotStatus {
  no_camera,    ///< camera or pose is unknown
  out_of_view,  ///< outside the image or the range of the sensor
  hidden,       ///< something stands before it
  seen,         ///< a surface was measured there
  seen_empty,   ///< a surface was measured behind it
  no_depth,     ///< in view, but nothing was measured there
};
/// The name in answers: "seen_empty"; "unknown" for no_camera.
const char* to_text(SpotStatus status);

/// The small depth image of a scene with the camera scaled to it: enough to say later whether a spot was
/// looked at.
class DepthThumbnail {
 public:
  /// From the scene's row and its blob; unset when the scene has no thumbnail.
  static std::optional<DepthThumbnail> of(const Store& store, const SceneRow& scene);

  /// z-depth per pixel of the thumbnail, metres, 0 = none.
  DepthThumbnail(SceneCamera camera, Isometry3d map_from_camera, int width, int height,
                 std::vector<float> depth);

  /// Judges a point of the map frame; measurements within `tolerance_m` of it count as being there.
  SpotStatus spot_status(const Vector3d& point, double tolerance_m = 0.04) const;

  int width() const { return width_; }
  int height() const { return height_; }
  const std::vector<float>& depth() const { return depth_; }

 private:
  SceneCamera camera_;
  Isometry3d camera_from_map_;
  int width_, height_;
  std::vector<float> depth_;
};

/// The bytes of a thumbnail blob from z-depths in metres (0 or NaN = none): uint16, little endian, mm.
std::string encode_depth_thumbnail(const std::vector<float>& depth);
std::vector<float> decode_depth_thumbnail(std::string_view bytes);
/// The blob's media type.
inline constexpr const char* kDepthThumbnailMedia = "depth/uint16-mm";

}  // namespace loci::memory
