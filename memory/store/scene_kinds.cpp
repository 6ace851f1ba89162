#include "memory/store/scene_kinds.h"

#include <algorithm>

namespace loci::memory {

std::optional<SceneKinds> scene_kinds(const Store& store, const SceneRow& scene) {
  if (!scene.kinds) return std::nullopt;
  const std::string bytes = store.blob(*scene.kinds).bytes;
  SceneKinds kinds{scene.depth_width, scene.depth_height, {}};
  if (static_cast<int64_t>(bytes.size()) != int64_t{kinds.width} * kinds.height)
    throw Error("the pixel kinds of scene " + std::to_string(scene.id) + " have another size than its depth",
                {store.path().string(), 0, {}});
  for (const char byte : bytes)
    kinds.pixels.push_back(
        static_cast<mapping::PixelKind>(std::clamp<int>(byte, 0, mapping::kPixelKinds - 1)));
  return kinds;
}

}  // namespace loci::memory
