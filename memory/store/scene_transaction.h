#pragma once

#include "memory/store/store.h"

namespace loci::memory {

/// Several changes as one: runs, scenes and rows that are added while it is open are in the memory after
/// commit(), and none of them without it.
class ChangeTransaction {
 public:
  explicit ChangeTransaction(Store& store);
  ~ChangeTransaction();  ///< rolls back unless committed
  ChangeTransaction(const ChangeTransaction&) = delete;
  ChangeTransaction& operator=(const ChangeTransaction&) = delete;

  void commit();

 private:
  Store::Connection& db_;
  bool open_ = true;
};

/// Adds one scene with everything that it changes: after commit() all of it is in the memory, without it
/// nothing. Ids ascend in the order of adding. Of a row's bitemporal fields only valid_from is taken, 0 = the
/// time of the scene; known_from and run are filled in.
class SceneTransaction {
 public:
  /// `run` is from Store::begin_run; 0 where only such rows are added that have no run (Store::add_map and
  /// the like take part in an open transaction). Error when the store is open for reading only.
  SceneTransaction(Store& store, Id run);
  ~SceneTransaction();  ///< rolls back unless committed
  SceneTransaction(const SceneTransaction&) = delete;
  SceneTransaction& operator=(const SceneTransaction&) = delete;

  /// The known time of everything in this transaction.
  TimeNs known() const { return known_; }

  Id add_scene(const SceneRow& row);
  /// The place with this name, added when it is new.
  Id add_place(const PlaceRow& row);
  /// The blob with this content, added when it is new.
  Id add_blob(std::string_view bytes, const std::string& media);
  Id add_observation(const ObservationRow& row);
  Id add_annotation(const AnnotationRow& row);
  void add_log(const LogRow& row);
  /// The type system with this text, added when it is new.
  Id add_type_system(std::string_view text);
  Id add_feature_structure(const FeatureStructureRow& row);
  /// From here on the tables that follow from others are not kept up to date; commit() makes them anew. For
  /// many rows about the past, each of which would change what follows from all later ones.
  void postpone_derived() { postponed_ = true; }
  Id add_object(const ObjectRow& row);
  Id add_association(const AssociationRow& row);
  Id add_event(const EventRow& row);
  Id add_belief(const BeliefRow& row);
  Id add_visibility(const VisibilityRow& row);
  Id add_fact(const FactRow& row);

  /// What the belief concluded about a scene, to explain it and to reason again; replaces an older one.
  void set_reasoning(Id scene, std::string_view bytes);
  /// The state of a program after this scene; replaces the one of this name.
  void set_checkpoint(const std::string& name, std::string_view bytes, std::optional<Id> scene);
  /// Removes those with a prefix.
  void drop_checkpoints(const std::string& prefix);

  void commit();

 private:
  /// `momentary`: it holds at one moment, unless valid_to is set.
  template <class Row>
  Row stamped(const Row& row, bool momentary = false) const;

  Store::Connection& db_;
  Id run_;
  TimeNs known_;
  TimeNs scene_time_ = 0;  ///< of the scene added last
  bool open_ = true, postponed_ = false;
};

}  // namespace loci::memory
