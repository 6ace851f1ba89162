#include "memory/recorder/scene_reasoning.h"

#include "memory/belief/serialization.h"

namespace loci::memory {

void save_reasoning(SceneTransaction& transaction, Id scene, const SceneReasoning& reasoning) {
  transaction.set_reasoning(scene, belief::to_bytes(reasoning));
}

std::optional<SceneReasoning> load_reasoning(const Store& store, Id scene) {
  const std::optional<std::string> bytes = store.reasoning(scene);
  if (!bytes) return std::nullopt;
  try {
    return belief::reasoning_from_bytes(*bytes);
  } catch (const Error& error) {
    throw Error(error.message(), {store.name(), 0, {}},
                "use that version, or perceive the recording again: loci-perceive run RECORDING -m NEW.loci");
  }
}

}  // namespace loci::memory
