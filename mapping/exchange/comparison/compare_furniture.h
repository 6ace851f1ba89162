#pragma once

#include "mapping/exchange/comparison/compare.h"

namespace loci::mapping {

/// Adds the openings of walls, where the truth lists them.
void compare_openings(const MapStructure& map, const MapStructure& truth, const ComparisonOptions& options,
                      Comparison& result);

/// Adds handles, knobs, fronts and their joints to a comparison.
void compare_furniture(const MapStructure& map, const MapStructure& truth, const ComparisonOptions& options,
                       Comparison& result);

/// Intersection over union of two rectangles in the second one's plane, into which the first is projected; 0
/// where their normals differ by more than 45° or their planes by more than 10 cm.
double overlap_of(const Front& a, const Front& b);

/// Axis and hinge of a joint against the true one, where both are of one type.
ComparedJoint compare_joints(const std::optional<JointEstimate>& map, const JointEstimate& truth,
                             const Vector3d& front_centre);

/// Whether the options ask for a region of the truth.
bool asked_for(const std::string& region, const ComparisonOptions& options);

}  // namespace loci::mapping
