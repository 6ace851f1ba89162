#pragma once

#include "memory/belief/evidence/prediction.h"

namespace loci::memory::belief {

// Effect of one observation on the object that it is assigned to. Positions are stored in the frame of the
// place, so that objects in a drawer move with it.

/// Resets position and size to the observation.
void reset_box(ProtoObject& object, const Observation& observation, const Scene& scene,
               const BeliefOptions& options);

/// Fuses predicted and observed position and size, weighted by their variances.
void fuse_box(ProtoObject& object, const Prediction& predicted, const Observation& observation,
              const Scene& scene, const BeliefOptions& options);

/// Changes the supporting place and keeps the position in the map.
void set_place(ProtoObject& object, const std::string& place, const Scene& scene);

/// Stores the view. It replaces a similar one; a dissimilar one is only stored if `position_confirmed`: the
/// identity rests on more than appearance.
void store_view(ProtoObject& object, const Observation& observation, const Scene& scene,
                const BeliefOptions& options, const Corrections& corrections, bool position_confirmed);

/// Adds what is seen of the surface; what is hidden now is kept unless the object moved.
void store_surface(ProtoObject& object, const Surface& seen, const std::vector<PointState>& before,
                   const Scene& scene, bool moved);

/// Keeps the texture of a side that is not kept yet. `moved`: the object is where it was not before.
/// `learn`: the observation is surely of this object.
void store_texture(ProtoObject& object, const Observation& observation, const Scene& scene, bool moved,
                   bool learn);

/// Most probable class over the stored views; empty = not classified.
std::string most_probable_class(const ProtoObject& object);

}  // namespace loci::memory::belief
