#pragma once

#include "memory/recorder/recorder.h"
#include "perception/types/scene_cas.h"

namespace loci::memory {

/// Writes what was resolved into the CAS: per cluster that is a known object a TrackingAnnotation, further
/// ones for what each simple tracker takes it for (annotator_id: PositionTracker, ShapeTracker, ColorTracker)
/// and, where it settled it, the Arbiter; the matrices of similarities and distances, and the
/// BeliefStateInstance (§3.2.5, §6.1.2).
void annotate_belief(const perception::types::SceneCas& cas, const ResolvedScene& resolved);

/// What the trackers and the arbiter said about a cluster, to be kept with it; who it is is kept anyhow.
std::vector<perception::cas::FeatureStructure> tracker_votes(const perception::types::Cluster& cluster);

}  // namespace loci::memory
