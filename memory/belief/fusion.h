#pragma once

#include "memory/belief/evidence.h"

namespace loci::memory::belief {

// What one observation changes in what is believed of the object that it shows. Positions are kept in the
// frame of the place, so that what lies in a drawer moves with it.

/// A fresh start of position and size.
void put(ProtoObject& object, const Observation& observation, const Scene& scene,
         const BeliefOptions& options);

/// Position and size from what was expected and what was seen, each by its variance.
void fuse(ProtoObject& object, const Expectation& expected, const Observation& observation,
          const Scene& scene, const BeliefOptions& options);

/// Changes what the object stands on without moving it.
void set_place(ProtoObject& object, const std::string& place, const Scene& scene);

/// Keeps a few looks that differ: one that says what a known one says takes its place. One that says
/// something else is only kept when more than the look itself vouches for it (where it stands).
void remember_look(ProtoObject& object, const Observation& observation, const Scene& scene,
                   const BeliefOptions& options, bool vouched_for);

/// What its looks are called most of all; empty = no classifier has said anything.
std::string kind_of(const ProtoObject& object);

}  // namespace loci::memory::belief
