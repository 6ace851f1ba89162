#include "memory/recorder/checkpoint.h"

#include <fmt/format.h>

#include <set>

#include "mapping/base/config.h"
#include "mapping/base/text/json.h"
#include "memory/belief/serialization.h"

namespace loci::memory {
namespace {

constexpr const char* kCheckpoint = "belief";
constexpr const char* kOptions = "options";
constexpr const char* kObjects = "belief/";  ///< and the object's key, so that names sort like the objects

constexpr const char* kTextures = "belief_texture/";  ///< object's key and time of the view

std::string object_checkpoint(int64_t key) {
  return fmt::format("{}{:019}", kObjects, key);
}

std::string texture_checkpoint(int64_t key, TimeNs time) {
  return fmt::format("{}{:019}/{:+020}", kTextures, key, time);
}

/// Of what is kept for the undo of a run.
std::string kept_before(Id run) {
  return fmt::format("{}{}/", kKeptBeliefs, run);
}

std::string text_of(belief::BeliefOptions options) {
  return table_of(options).to_json().dump();
}

}  // namespace

void BeliefCheckpoint::set_options(const belief::BeliefOptions& options) {
  options_saved_ = options_saved_ && text_of(options) == text_of(options_);
  options_ = options;
}

void BeliefCheckpoint::save(SceneTransaction& transaction, Id scene, const belief::BeliefState& state) {
  transaction.set_checkpoint(kCheckpoint, to_bytes(state), scene);
  if (!options_saved_) transaction.set_checkpoint(kOptions, text_of(options_), std::nullopt);
  if (all_)
    for (const char* prefix : {kObjects, kTextures}) transaction.drop_checkpoints(prefix);
  fresh_.clear();
  removed_.clear();
  std::set<std::string> believed;
  for (const belief::ProtoObject& object : state.objects) {
    const std::string name = *believed.insert(object_checkpoint(object.key)).first;
    std::string bytes = to_bytes(object);
    const auto before = stored_.find(name);
    if (before == stored_.end() || before->second != bytes) {
      transaction.set_checkpoint(name, bytes, std::nullopt);
      fresh_[name] = std::move(bytes);
    }
    for (const belief::TextureView& view : object.textures) {
      const std::string texture = *believed.insert(texture_checkpoint(object.key, view.time)).first;
      if (stored_.contains(texture)) continue;  // the texture of a view does not change
      transaction.set_checkpoint(texture, to_bytes(view.texture), std::nullopt);
      fresh_[texture] = {};
    }
  }
  for (const auto& [name, bytes] : stored_)
    if (!believed.contains(name)) removed_.push_back(name);
  for (const std::string& name : removed_) transaction.drop_checkpoints(name);
}

void BeliefCheckpoint::committed() {
  for (const std::string& name : removed_) stored_.erase(name);
  for (auto& [name, bytes] : fresh_) stored_[name] = std::move(bytes);
  fresh_.clear();
  removed_.clear();
  all_ = false;
  options_saved_ = true;
}

void BeliefCheckpoint::reset() {
  *this = BeliefCheckpoint(options_);
}

belief::BeliefState load_belief(const Store& store) {
  const std::optional<SceneRow> last = store.last_scene();
  return last ? load_belief(store, last->id) : belief::BeliefState();
}

namespace {

/// The belief from the checkpoints whose names begin with a prefix; `common`: of its common part.
belief::BeliefState read_belief(const Store& store, const std::string& prefix, const std::string& common) {
  try {
    belief::BeliefState state = belief::state_from_bytes(common);
    for (const auto& [name, object] : store.checkpoints(prefix + kObjects))
      state.objects.push_back(belief::object_from_bytes(object.bytes));
    const auto textures = store.checkpoints(prefix + kTextures);
    for (belief::ProtoObject& object : state.objects)
      for (belief::TextureView& view : object.textures) {
        const auto texture = textures.find(prefix + texture_checkpoint(object.key, view.time));
        if (texture == textures.end()) throw Error("the texture of an object is missing");
        view.texture = belief::texture_from_bytes(texture->second.bytes);
      }
    return state;
  } catch (const Error& error) {
    throw Error(error.message(), {store.path().string(), 0, {}}, error.hint());
  }
}

}  // namespace

belief::BeliefState load_belief(const Store& store, Id scene) {
  const auto checkpoint = store.checkpoint(kCheckpoint);
  if (!checkpoint || checkpoint->scene != scene) return {};
  return read_belief(store, "", checkpoint->bytes);
}

belief::BeliefOptions load_options(const Store& store) {
  const auto checkpoint = store.checkpoint(kOptions);
  if (!checkpoint) return {};
  return read_options<belief::BeliefOptions>(Config::parse(checkpoint->bytes, store.path().string()));
}

void keep_belief(SceneTransaction& transaction, const Store& store, Id run) {
  for (const auto& [name, checkpoint] : store.checkpoints(kCheckpoint))
    transaction.set_checkpoint(kept_before(run) + name, checkpoint.bytes, checkpoint.scene);
}

std::optional<Id> restore_belief(SceneTransaction& transaction, const Store& store, Id run) {
  const std::string prefix = kept_before(run);
  const auto kept = store.checkpoints(prefix);
  const auto common = kept.find(prefix + kCheckpoint);
  if (common == kept.end()) return std::nullopt;
  transaction.drop_checkpoints(kCheckpoint);
  for (const auto& [name, checkpoint] : kept)
    transaction.set_checkpoint(name.substr(prefix.size()), checkpoint.bytes, checkpoint.scene);
  return common->second.scene;
}

void drop_kept_belief(SceneTransaction& transaction, Id run) {
  transaction.drop_checkpoints(kept_before(run));
}

namespace {

constexpr Id kReview = 0;  ///< no run has this number
constexpr const char* kPending = "review";
constexpr const char* kContradicted = "contradicted";

}  // namespace

void begin_review(SceneTransaction& transaction, const Store& store) {
  if (store.checkpoint(kept_before(kReview) + kPending)) return;
  keep_belief(transaction, store, kReview);
  transaction.set_checkpoint(kept_before(kReview) + kPending, {}, std::nullopt);
}

void note_contradiction(SceneTransaction& transaction) {
  transaction.set_checkpoint(kept_before(kReview) + kContradicted, {}, std::nullopt);
}

std::optional<PendingReview> load_review(const Store& store) {
  const std::string prefix = kept_before(kReview);
  if (!store.checkpoint(prefix + kPending)) return std::nullopt;
  PendingReview review;
  review.contradicted = store.checkpoint(prefix + kContradicted).has_value();
  if (const auto kept = store.checkpoint(prefix + kCheckpoint)) {
    review.before = read_belief(store, prefix, kept->bytes);
    review.after = kept->scene.value_or(0);
  }
  return review;
}

void end_review(SceneTransaction& transaction) {
  drop_kept_belief(transaction, kReview);
}

}  // namespace loci::memory
