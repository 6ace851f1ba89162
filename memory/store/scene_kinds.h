#pragma once

#include <optional>
#include <vector>

#include "mapping/sensor/pixel_kind.h"
#include "memory/store/store.h"

namespace loci::memory {

/// A kind per pixel of the scene's depth thumbnail, row by row.
struct SceneKinds {
  int width = 0, height = 0;
  std::vector<mapping::PixelKind> pixels;
};

/// Unset when the scene was perceived without a map, was let go, or is of an earlier version. Error when the
/// image has another size than the thumbnail.
std::optional<SceneKinds> scene_kinds(const Store& store, const SceneRow& scene);

/// The media type of the blob, which is a byte per pixel.
inline constexpr const char* kSceneKindsMedia = "pixels/kind";

}  // namespace loci::memory
