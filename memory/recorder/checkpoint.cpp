#include "memory/recorder/checkpoint.h"

#include <fmt/format.h>

#include <set>

#include "memory/belief/serialization.h"

namespace loci::memory {
namespace {

constexpr const char* kCheckpoint = "belief";
constexpr const char* kObjects = "belief/";  ///< and the object's key, so that names sort like the objects

std::string object_checkpoint(int64_t key) {
  return fmt::format("{}{:019}", kObjects, key);
}

}  // namespace

void BeliefCheckpoint::save(SceneTransaction& transaction, Id scene, const belief::BeliefState& state) {
  transaction.set_checkpoint(kCheckpoint, to_bytes(state), scene);
  if (all_) transaction.drop_checkpoints(kObjects);
  fresh_.clear();
  removed_.clear();
  std::set<int64_t> believed;
  for (const belief::ProtoObject& object : state.objects) {
    std::string bytes = to_bytes(object);
    const auto before = stored_.find(object.key);
    believed.insert(object.key);
    if (before != stored_.end() && before->second == bytes) continue;
    transaction.set_checkpoint(object_checkpoint(object.key), bytes, std::nullopt);
    fresh_[object.key] = std::move(bytes);
  }
  for (const auto& [key, bytes] : stored_)
    if (!believed.contains(key)) removed_.push_back(key);
  for (const int64_t key : removed_) transaction.drop_checkpoints(object_checkpoint(key));
}

void BeliefCheckpoint::committed() {
  for (const int64_t key : removed_) stored_.erase(key);
  for (auto& [key, bytes] : fresh_) stored_[key] = std::move(bytes);
  fresh_.clear();
  removed_.clear();
  all_ = false;
}

void BeliefCheckpoint::reset() {
  *this = {};
}

belief::BeliefState load_belief(const Store& store) {
  const std::optional<SceneRow> last = store.last_scene();
  if (!last) return {};
  const auto checkpoint = store.checkpoint(kCheckpoint);
  if (!checkpoint || checkpoint->scene != last->id) return {};
  try {
    belief::BeliefState state = belief::state_from_bytes(checkpoint->bytes);
    for (const auto& [name, object] : store.checkpoints(kObjects))
      state.objects.push_back(belief::object_from_bytes(object.bytes));
    return state;
  } catch (const Error& error) {
    throw Error(error.message(), {store.path().string(), 0, {}});
  }
}

}  // namespace loci::memory
