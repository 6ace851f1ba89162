#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "memory/store/store.h"

namespace loci::memory {

/// What a pixel of a scene is (Fig. 2.1), as the known structure filter told.
enum class SceneKind : uint8_t {
  unmeasured = 0,
  known = 1,       ///< the map or a robot explains it
  irrelevant = 2,  ///< in no region of interest
  interest = 3,
};

/// A kind per pixel of the scene's depth thumbnail, row by row.
struct SceneKinds {
  int width = 0, height = 0;
  std::vector<SceneKind> pixels;
};

/// Unset when the scene was perceived without a map, was let go, or is of an earlier version. Error when the
/// image has another size than the thumbnail.
std::optional<SceneKinds> scene_kinds(const Store& store, const SceneRow& scene);

/// The media type of the blob, which is a byte per pixel.
inline constexpr const char* kSceneKindsMedia = "pixels/kind";

}  // namespace loci::memory
