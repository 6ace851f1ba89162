#pragma once

#include "memory/belief/state.h"

namespace loci::memory {

/// How the probability that an object is where it was seen fades while nobody looks: after t seconds it has
/// become p * (share + (1 - share) * exp(-t / time_s)).
struct Fading {
  double time_s = 0, share = 1;
};

/// What the habits of the home say from now on, as the curve of that form that is right when the first
/// twentieth is lost and at its end, after six times the usual time of handling.
Fading fading_of(const belief::ProtoObject& object, const belief::BeliefState& state,
                 const belief::BeliefOptions& options);

}  // namespace loci::memory
