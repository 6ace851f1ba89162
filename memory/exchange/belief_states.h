#pragma once

#include <functional>

#include "mapping/base/progress.h"
#include "mapping/base/text/json_fwd.h"
#include "memory/store/store.h"

namespace loci::memory {

/// The belief about the state of the world after a scene (BeliefStateInstance, §3.2.5), put together from
/// what the memory keeps, so that it costs no bytes there:
///   scene, time
///   current_clusters, previous_clusters   what was seen now, and at the last time step before
///   known_objects       all that are known: status, probability of being there, place, position
///   persisting_objects  those of them that were not seen now but are believed to be where they were
///   relations           on, in (a place), next_to (boxes at most 5 cm apart): predicate, subject, object
///   identities          of each current cluster: candidates (known objects) with probability, new, false
///   tracking            of each current cluster: previous clusters and persisting objects with probability
/// Clusters are called cluster_SCENE_NUMBER.
Json belief_state(const Store& store, const SceneRow& scene, const std::optional<SceneRow>& previous);

/// One per scene, in order of time.
void for_each_belief_state(const Store& store, Progress& progress,
                           const std::function<void(const Json&)>& visitor);

}  // namespace loci::memory
