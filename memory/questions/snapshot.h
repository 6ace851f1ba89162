#pragma once

#include <map>
#include <unordered_map>

#include "mapping/base/error.h"
#include "memory/questions/answers.h"
#include "memory/questions/part_names.h"
#include "memory/questions/taxonomy.h"

namespace loci::memory {

/// Thrown when words mean nothing in this memory.
class UnknownName : public Error {
 public:
  enum class Kind { object, place };
  UnknownName(Kind kind, const std::string& what, const FileLocation& where, const std::string& hint)
      : Error(what, where, hint), kind_(kind) {}
  Kind kind() const { return kind_; }

 private:
  Kind kind_;
};

/// What the memory believes as of two clocks, with names in place of ids. Read once per question, of one
/// moment, and only what the question needs.
class Snapshot {
 public:
  Snapshot(const Store& store, const AsOf& as_of);

  const Store& store() const { return store_; }
  const AsOf& as_of() const { return as_of_; }
  const std::vector<BeliefRow>& beliefs() const;
  const std::vector<PlaceRow>& places() const { return places_; }
  const std::vector<FactRow>& facts() const { return facts_; }
  /// What people called parts of the map that are no places.
  const PartNames& part_names() const;
  /// Scenes up to `at`, known at `known_at`, in order of time.
  const std::vector<SceneRow>& scenes() const;
  const BeliefRow* belief(Id object) const;
  const SceneRow* scene(Id id) const;

  SceneRef scene_ref(const SceneRow& scene) const;
  std::optional<SceneRef> scene_ref(std::optional<Id> id) const;
  ObjectRef object_ref(Id object) const;
  std::optional<PlaceRef> place_ref(std::optional<Id> place) const;
  ObjectState state(const BeliefRow& belief) const;
  Change change(const EventRow& event) const;
  SceneSummary summary(const SceneRow& scene) const;

  /// Objects that X means, most probable first, then most recent. X: "object_12", an alias, words for colour,
  /// size, class (or another word or a wider kind of it, by the taxonomy), text, property, "Ada's" for an
  /// owner, "on PLACE", or several of these together; empty = all. UnknownName with the nearest names when it
  /// means nothing.
  std::vector<Id> find_objects(const std::string& subject) const;
  /// Places that a name means: those called so, else by its last word ("couch table" is any table).
  /// UnknownName with the nearest names when it means nothing.
  std::vector<PlaceRow> find_places(const std::string& name) const;
  /// Places by name ("table_1", "table 1"), alias, the beginning of the name (drawer_3 for drawer_3_bottom),
  /// or class (table for table_1); empty when there are none.
  std::vector<PlaceRow> places_called(const std::string& name) const;

 private:
  std::vector<Id> find_at_place(const std::vector<std::string>& words) const;
  std::vector<Id> there_now(Id place) const;
  std::vector<Id> find_by_word(const std::string& word) const;
  std::vector<std::string> known_names() const;
  /// What may be meant instead where words[unknown] means nothing.
  std::string hint_for(const std::vector<std::string>& words, size_t unknown) const;

  const Store& store_;
  Store::ReadTransaction moment_;
  AsOf as_of_;
  std::vector<PlaceRow> places_;
  std::vector<FactRow> facts_;
  Taxonomy taxonomy_;
  std::map<Id, std::string> recordings_;
  // Read when first asked for.
  mutable std::optional<std::vector<BeliefRow>> beliefs_;
  mutable std::unordered_map<Id, std::optional<BeliefRow>> belief_of_;
  mutable std::optional<PartNames> part_names_;
  mutable std::optional<std::vector<SceneRow>> scenes_;
  mutable std::unordered_map<Id, std::optional<SceneRow>> scene_of_;
};

/// So much of a place must have been seen to say that something is not there.
inline constexpr double kEnoughSeen = 0.5;

/// The middle of a place, map frame; unset when its shape and pose are unknown.
std::optional<Vector3d> centre_of(const PlaceRow& place);

/// Size words: small, medium, large, tall, flat.
bool is_size_word(const std::string& word);
bool has_size(const std::string& word, const Vector3d& size);

}  // namespace loci::memory
