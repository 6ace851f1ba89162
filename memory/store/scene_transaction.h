#pragma once

#include "memory/store/store.h"

namespace loci::memory {

/// One scene with everything that it changes: all of it is in the memory after commit(), nothing before or
/// without. Ids are given in the order of adding. A row's clock needs no more than valid_from, where it is
/// not the scene's time: known_from and run are filled in.
class SceneTransaction {
 public:
  /// Begins; `run` is from Store::begin_run. Error when the store is open for reading only.
  SceneTransaction(Store& store, Id run);
  ~SceneTransaction();  ///< takes everything back unless committed
  SceneTransaction(const SceneTransaction&) = delete;
  SceneTransaction& operator=(const SceneTransaction&) = delete;

  /// The known time of everything in this transaction.
  TimeNs known() const { return known_; }

  Id add_scene(const SceneRow& row);
  /// The place of this name, added when it is new.
  Id add_place(const PlaceRow& row);
  /// The blob of this content, added when it is new.
  Id add_blob(std::string_view bytes, const std::string& media);
  Id add_observation(const ObservationRow& row);
  Id add_annotation(const AnnotationRow& row);
  void add_log(const LogRow& row);
  /// The type system of this text, added when it is new.
  Id add_type_system(std::string_view text);
  Id add_feature_structure(const FeatureStructureRow& row);
  Id add_object(const ObjectRow& row);
  Id add_association(const AssociationRow& row);
  Id add_event(const EventRow& row);
  Id add_belief(const BeliefRow& row);
  Id add_visibility(const VisibilityRow& row);
  Id add_fact(const FactRow& row);

  /// What the belief made of a scene, to explain it and to reason anew.
  void set_reasoning(Id scene, std::string_view bytes);
  /// Keeps a program's own state as it is after this scene; replaces the one of that name.
  void set_checkpoint(const std::string& name, std::string_view bytes, std::optional<Id> scene);

  /// Removes those whose names begin so.
  void drop_checkpoints(const std::string& prefix);

  void commit();

 private:
  Store::Implementation& store_;
  Id run_;
  TimeNs known_;
  TimeNs scene_time_ = 0;  ///< of the scene added last
  bool open_ = true;
};

}  // namespace loci::memory
