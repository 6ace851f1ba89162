#include "memory/recorder/carried_belief.h"

#include <fmt/format.h>

#include <algorithm>

namespace loci {
namespace {

constexpr const char* kCheckpoint = "belief";
constexpr const char* kObjects = "belief/";  ///< and the object's key, so that names sort like the objects
/// The first files kept a belief with every scene: a blob, named by an annotation of this type.
constexpr const char* kEarlierType = "loci.memory.CarriedBelief";

std::string name_of(int64_t key) {
  return fmt::format("{}{:019}", kObjects, key);
}

}  // namespace

void CarriedBelief::save(SceneTransaction& transaction, Id scene, const belief::BeliefState& state) {
  belief::BeliefState common;
  common = state;
  common.objects.clear();
  transaction.set_checkpoint(kCheckpoint, belief::to_bytes(common), scene);
  if (all_) transaction.drop_checkpoints(kObjects);
  fresh_.clear();
  removed_.clear();
  for (const auto& [key, bytes] : kept_) removed_.push_back(key);
  for (const belief::ProtoObject& object : state.objects) {
    belief::BeliefState alone;
    alone.objects = {object};
    std::string bytes = belief::to_bytes(alone);
    const auto kept = kept_.find(object.key);
    if (kept != kept_.end()) std::erase(removed_, object.key);
    if (kept != kept_.end() && kept->second == bytes) continue;
    transaction.set_checkpoint(name_of(object.key), bytes, std::nullopt);
    fresh_[object.key] = std::move(bytes);
  }
  for (const int64_t key : removed_) transaction.drop_checkpoints(name_of(key));
}

void CarriedBelief::committed() {
  for (const int64_t key : removed_) kept_.erase(key);
  for (auto& [key, bytes] : fresh_) kept_[key] = std::move(bytes);
  fresh_.clear();
  removed_.clear();
  all_ = false;
}

void CarriedBelief::start_anew() {
  *this = {};
}

belief::BeliefState load_belief(const Store& store) {
  const std::optional<SceneRow> last = store.last_scene();
  if (!last) return {};
  if (const auto checkpoint = store.checkpoint(kCheckpoint); checkpoint && checkpoint->scene == last->id) {
    belief::BeliefState state = belief::belief_state_from_bytes(checkpoint->bytes);
    for (const auto& [name, part] : store.checkpoints(kObjects)) {
      belief::BeliefState alone = belief::belief_state_from_bytes(part.bytes);
      std::ranges::move(alone.objects, std::back_inserter(state.objects));
    }
    return state;
  }
  for (const AnnotationRow& row : store.annotations(last->id)) {
    if (row.type != kEarlierType) continue;
    const std::optional<Id> blob = store.find_blob(row.value);
    if (!blob) throw Error("the belief after the last scene is missing", {store.path().string(), 0, {}});
    return belief::belief_state_from_bytes(store.blob(*blob).bytes);
  }
  return {};  // the last scene was not recorded by us
}

}  // namespace loci
