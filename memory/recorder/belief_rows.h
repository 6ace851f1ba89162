#pragma once

#include "memory/belief/belief.h"
#include "memory/recorder/scene_record.h"
#include "memory/store/store.h"

namespace loci::memory {

/// A scene and its effect on the belief.
struct BeliefChange {
  const Store& store;
  const SceneRecord& record;
  const std::vector<belief::PlacePose>& place_poses;
  Id scene = 0;
  const std::vector<Id>& observations;  ///< of the scene, in the order of the record
  const belief::BeliefUpdate& update;
  const belief::BeliefState& after;
  const belief::BeliefOptions& options;
  const std::map<std::string, Id>& places;  ///< by name
  const std::map<Id, BeliefRow>& before;    ///< last row of each believed object
};

/// The rows by which a scene changes what is believed. Their clocks have valid_from and source.
struct BeliefRows {
  std::map<Id, ObjectRow> objects;  ///< new ones
  std::vector<AssociationRow> associations;
  std::vector<EventRow> events;  ///< of objects
  std::vector<BeliefRow> beliefs;
  std::vector<VisibilityRow> visibility;  ///< of objects
  std::map<Id, BeliefRow> last;           ///< last row of each object that was believed anew or observed
};
BeliefRows belief_rows(const BeliefChange& change);

/// Takes over `last`, and drops objects that are believed no longer.
void update_last(std::map<Id, BeliefRow>& before, BeliefRows& rows, const belief::BeliefState& state);

}  // namespace loci::memory
