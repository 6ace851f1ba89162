#include "memory/store/scene_kinds.h"

#include <algorithm>

namespace loci::memory {

std::optional<SceneKinds> scene_kinds(const Store& store, const SceneRow& scene) {
  if (!scene.kinds) return std::nullopt;
  const std::string bytes = store.blob(*scene.kinds).bytes;
  SceneKinds kinds{scene.depth_width, scene.depth_height, {}};
  if (static_cast<int64_t>(bytes.size()) != int64_t{kinds.width} * kinds.height)
    throw Error("what the pixels of scene " + std::to_string(scene.id) + " are is told of another size",
                {store.path().string(), 0, {}});
  for (const char byte : bytes) kinds.pixels.push_back(static_cast<SceneKind>(std::clamp<int>(byte, 0, 3)));
  return kinds;
}

}  // namespace loci::memory
