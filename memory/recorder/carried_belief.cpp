#include "memory/recorder/carried_belief.h"

#include "mapping/base/hash.h"
#include "memory/recorder/recorder.h"

namespace loci {
namespace {

constexpr const char* kType = "loci.memory.CarriedBelief";
constexpr const char* kMedia = "application/cbor";

}  // namespace

void save_belief(SceneTransaction& transaction, Id scene, const belief::BeliefState& state) {
  const std::string bytes = belief::to_bytes(state);
  transaction.add_blob(bytes, kMedia);
  AnnotationRow row;
  row.scene = scene;
  row.type = kType;
  row.value = content_hash(bytes);
  transaction.add_annotation(row);
}

belief::BeliefState load_belief(const Store& store) {
  Id last = 0;
  for (const SceneRow& scene : store.scenes()) last = std::max(last, scene.id);
  if (last == 0) return {};
  for (const AnnotationRow& row : store.annotations(last)) {
    if (row.type != kType) continue;
    const std::optional<Id> blob = store.find_blob(row.value);
    if (!blob) throw Error("the belief after the last scene is missing", {store.path().string(), 0, {}});
    return belief::belief_state_from_bytes(store.blob(*blob).bytes);
  }
  return {};  // the last scene was not recorded by us
}

}  // namespace loci
