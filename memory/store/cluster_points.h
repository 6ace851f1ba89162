#pragma once

#include <optional>
#include <span>
#include <vector>

#include "memory/store/store.h"

namespace loci::memory {

/// The points of an observation, as the depth camera saw them at its full resolution, rounded to millimetres
/// of z-depth. Their colours are those of the scene's image, which is kept as long.
struct ClusterPoints {
  std::vector<int32_t> pixels;          ///< in the depth image, v * camera width + u, ascending
  std::vector<Eigen::Vector3f> points;  ///< camera frame, metres; one per pixel
};

/// Unset when none are kept: the memory was told not to, they were let go (with the images), forgotten, or
/// written by an earlier version; also without camera, mask or region of interest. Error when the blob does
/// not fit the mask.
std::optional<ClusterPoints> cluster_points(const Store& store, const SceneRow& scene,
                                            const ObservationRow& observation);

/// The bytes of the blob: z-depths in metres of the pixels of the mask, row by row; 0 or NaN = none.
std::string encode_cluster_depth(std::span<const float> depth);
std::vector<float> decode_cluster_depth(std::string_view bytes);
/// The blob's media type.
inline constexpr const char* kClusterDepthMedia = "depth/uint16-mm-delta";

}  // namespace loci::memory
