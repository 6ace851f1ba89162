#pragma once

#include "memory/recorder/recorder.h"
#include "perception/types/scene_cas.h"

namespace loci {

/// Writes what was resolved into the CAS: a TrackingAnnotation per cluster that is a known object, the
/// matrices of similarities and distances, and the BeliefStateInstance (§3.2.5, §6.1.2).
void annotate_belief(const types::SceneCas& cas, const ResolvedScene& resolved);

}  // namespace loci
