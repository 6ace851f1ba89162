#pragma once

#include <vector>

#include "mapping/world/furniture.h"
#include "mapping/world/semantic_map.h"
#include "mapping/world/world.h"

namespace loci::mapping {

/// What is solid of a front, in its frame: x outward, y to the right of a person before it, z up.
struct FrontBody {
  Eigen::AlignedBox2d panel;   ///< y and z: the measured rectangle less its gaps
  Eigen::AlignedBox1d drawer;  ///< y of a drawer's box with its runners; empty of others
  double drawer_depth = 0;     ///< of that box behind the panel, m
};

Isometry3d map_from_front(const Front& front);

/// The hinge of a revolute joint where furniture has it: on the face, in the edge of the panel, if it was
/// found near there. Otherwise nothing turns without cutting into its neighbours.
Vector3d fitted_hinge(const Front& front, const FrontBody& body);

/// The bar or knob as it fits on its panel: no longer than it, and within it.
Fixture fitted_fixture(const Front& front, const FrontBody& body);

/// Appends the boxes that remain of one when another is cut out of it; slivers are left out.
void cut_out(const Eigen::AlignedBox3d& cut, const Eigen::AlignedBox3d& from,
             std::vector<Eigen::AlignedBox3d>& rest);

/// The bodies of fronts so that nothing penetrates another in the closed state: measured rectangles with the
/// gaps that furniture has, cut where they overlap with each other (the less certain one gives way) or with
/// walls, floor and other links; drawers as deep and as wide as there is room.
std::vector<FrontBody> fit_fronts(const std::vector<Front>& fronts, const World& world,
                                  const SemanticMap& semantics);

/// Makes room for fronts in the slabs of supports: a slab whose thickness is not known ends above the fronts
/// and handles below it; what still lies in one is cut out.
void cut_supports(const std::vector<Front>& fronts, const std::vector<FrontBody>& bodies, World& world,
                  const SemanticMap& semantics);

/// Limits the joints of fronts to how far they open before something of the map is in their way; the
/// sidecar names it ("blocked_by"). Where a joint would hardly move, the map errs: something gives way there.
void limit_joints(const std::vector<Front>& fronts, World& world, SemanticMap& semantics);

}  // namespace loci::mapping
