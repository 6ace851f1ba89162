#include "memory/recorder/carried_belief.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "memory/belief/archive.h"

namespace loci::memory {
namespace {

constexpr const char* kCheckpoint = "belief";
constexpr const char* kObjects = "belief/";  ///< and the object's key, so that names sort like the objects
constexpr uint8_t kVersion = 2;              ///< of an object; 1 had no leftovers
constexpr uint8_t kRestVersion = 4;          ///< of all but the objects; one less than the belief's
/// The first files kept a belief with every scene: a blob, named by an annotation of this type.
constexpr const char* kEarlierType = "loci.memory.CarriedBelief";

std::string name_of(int64_t key) {
  return fmt::format("{}{:019}", kObjects, key);
}

std::string bytes_of(const belief::ProtoObject& object, std::string room) {
  belief::ArchiveWriter writer(std::move(room));
  writer(kVersion, object);
  return writer.take();
}

std::string bytes_of_rest(const belief::BeliefState& state) {
  belief::ArchiveWriter writer;
  writer(kRestVersion);
  const_cast<belief::BeliefState&>(state).archive_rest(writer);  // writers only read
  return writer.take();
}

/// A reader after the version, which must not be above `newest`.
std::pair<belief::ArchiveReader, uint8_t> reader_of(const Store::Checkpoint& checkpoint, uint8_t newest,
                                                    const Store& store) {
  belief::ArchiveReader reader(checkpoint.bytes);
  uint8_t version = 0;
  reader(version);
  if (version == 0 || version > newest)
    throw Error("its belief was written by another version of loci", {store.path().string(), 0, {}});
  return {reader, version};
}

void read_rest(const Store::Checkpoint& checkpoint, const Store& store, belief::BeliefState& state) {
  auto [reader, version] = reader_of(checkpoint, kRestVersion, store);
  version < kRestVersion ? state.archive_rest_before_5(reader, version + 1) : state.archive_rest(reader);
}

belief::ProtoObject read_object(const Store::Checkpoint& checkpoint, const Store& store) {
  belief::ProtoObject object;
  auto [reader, version] = reader_of(checkpoint, kVersion, store);
  version == 1 ? object.archive_before_4(reader) : object.archive(reader);
  return object;
}

}  // namespace

void CarriedBelief::save(SceneTransaction& transaction, Id scene, const belief::BeliefState& state) {
  transaction.set_checkpoint(kCheckpoint, bytes_of_rest(state), scene);
  if (all_) transaction.drop_checkpoints(kObjects);
  fresh_.clear();
  removed_.clear();
  std::set<int64_t> believed;
  std::string bytes;
  for (const belief::ProtoObject& object : state.objects) {
    bytes = bytes_of(object, std::move(bytes));
    const auto kept = kept_.find(object.key);
    believed.insert(object.key);
    if (kept != kept_.end() && kept->second == bytes) continue;
    transaction.set_checkpoint(name_of(object.key), bytes, std::nullopt);
    fresh_[object.key] = bytes;
  }
  for (const auto& [key, kept] : kept_)
    if (!believed.contains(key)) removed_.push_back(key);
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
    // Files of format 1.0 keep all of it as one, which begins otherwise.
    if (checkpoint->bytes.empty() || static_cast<uint8_t>(checkpoint->bytes.front()) > kRestVersion)
      return belief::belief_state_from_bytes(checkpoint->bytes);
    belief::BeliefState state;
    read_rest(*checkpoint, store, state);
    for (const auto& [name, part] : store.checkpoints(kObjects))
      state.objects.push_back(read_object(part, store));
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

}  // namespace loci::memory
