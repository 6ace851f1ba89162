#pragma once

// Of this room alone.

#include <map>
#include <vector>

#include "memory/recorder/scene_reasoning.h"

namespace loci::memory {

using Looks = std::vector<std::vector<belief::Descriptor>>;

/// Classes and texts are compared as words are, over all sightings.
void drop_words(Looks& looks);

/// What objects looked like, out of the evidence that is kept with each scene.
class LooksOfObjects {
 public:
  explicit LooksOfObjects(const Store& store) : store_(store) {}

  /// At most six, spread over its sightings; whole views where there are any.
  Looks of(Id object);

 private:
  const belief::Observation* evidence(const ObservationRow& row);

  const Store& store_;
  std::map<Id, std::optional<SceneReasoning>> scenes_;
};

}  // namespace loci::memory
