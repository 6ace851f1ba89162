#pragma once

// The blobs of a scene's depth image: its thumbnail, what its pixels are, and the points of observations.

#include <optional>
#include <span>
#include <vector>

#include "mapping/sensor/camera.h"
#include "mapping/sensor/pixel_kind.h"
#include "memory/store/feature_structures.h"
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

/// The small depth image of a scene with the camera scaled to it: enough to tell later what the scene reports
/// about a spot.
class DepthThumbnail {
 public:
  /// Unset when the scene has no thumbnail, camera or pose.
  static std::optional<DepthThumbnail> of(const Store& store, const SceneRow& scene);

  /// z-depth per pixel of the thumbnail, metres, 0 = none.
  DepthThumbnail(const SceneCamera& camera, const Isometry3d& map_from_camera, int width, int height,
                 std::vector<float> depth);

  /// Of a point of the map frame; a measurement within `tolerance_m` of it counts as seen there.
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

/// The stored depth camera as a pinhole.
mapping::PinholeCamera pinhole_of(const SceneCamera& camera);

/// The cameras of a scene that has one: the depth camera is in its row, the colour camera in a feature
/// structure; without that the image is taken to be registered to the depth.
mapping::RgbdCamera cameras_of(const Store& store, const SceneRow& row);
/// Writes the colour camera of a scene, unless its image is registered to the depth.
void add_color_camera(FeatureStructureWriter& structures, const mapping::RgbdCamera& cameras);

/// The bytes of a thumbnail blob from z-depths in metres (0 or NaN = none): uint16, little endian, mm.
std::string encode_depth_thumbnail(const std::vector<float>& depth);
std::vector<float> decode_depth_thumbnail(std::string_view bytes);
/// The z-depths of a scene's thumbnail, as many as its row says (else Error); empty when it has none.
std::vector<float> depth_thumbnail(const Store& store, const SceneRow& scene);
inline constexpr const char* kDepthThumbnailMedia = "depth/uint16-mm";

/// A kind per pixel of the depth thumbnail, row by row.
struct PixelKindImage {
  int width = 0, height = 0;
  std::vector<mapping::PixelKind> pixels;
};
/// Unset when the scene was perceived without a map, or they were discarded. Error when the image has another
/// size than the thumbnail.
std::optional<PixelKindImage> pixel_kinds(const Store& store, const SceneRow& scene);
/// The blob has a byte per pixel.
inline constexpr const char* kPixelKindsMedia = "pixels/kind";

/// The points of an observation as the depth camera measured them at its full resolution, rounded to
/// millimetres of z-depth. Their colours are those of the scene's image, which is stored as long.
struct ClusterPoints {
  std::vector<int32_t> pixels;          ///< in the depth image, v * camera width + u, ascending
  std::vector<Eigen::Vector3f> points;  ///< camera frame, metres; one per pixel
};
/// Unset when none are stored (by choice, discarded with the images, forgotten), and without camera, mask or
/// region of interest. Error when the blob does not fit the mask.
std::optional<ClusterPoints> cluster_points(const Store& store, const SceneRow& scene,
                                            const ObservationRow& observation);
/// The bytes of the blob from the z-depths of the pixels of the mask, metres, row by row; 0 or NaN = none.
std::string encode_cluster_depth(std::span<const float> depth);
std::vector<float> decode_cluster_depth(std::string_view bytes);
inline constexpr const char* kClusterDepthMedia = "depth/uint16-mm-delta";

}  // namespace loci::memory
