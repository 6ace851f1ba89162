#include "memory/recorder/carried_belief.h"

#include "memory/recorder/recorder.h"

namespace loci {
namespace {

constexpr const char* kCheckpoint = "belief";
/// Earlier files kept a belief with every scene: a blob, named by an annotation of this type.
constexpr const char* kEarlierType = "loci.memory.CarriedBelief";

}  // namespace

void save_belief(SceneTransaction& transaction, Id scene, const belief::BeliefState& state) {
  transaction.set_checkpoint(kCheckpoint, belief::to_bytes(state), scene);
}

belief::BeliefState load_belief(const Store& store) {
  const std::optional<SceneRow> last = store.last_scene();
  if (!last) return {};
  if (const auto checkpoint = store.checkpoint(kCheckpoint); checkpoint && checkpoint->scene == last->id)
    return belief::belief_state_from_bytes(checkpoint->bytes);
  for (const AnnotationRow& row : store.annotations(last->id)) {
    if (row.type != kEarlierType) continue;
    const std::optional<Id> blob = store.find_blob(row.value);
    if (!blob) throw Error("the belief after the last scene is missing", {store.path().string(), 0, {}});
    return belief::belief_state_from_bytes(store.blob(*blob).bytes);
  }
  return {};  // the last scene was not recorded by us
}

}  // namespace loci
