#pragma once

#include "mapping/world/furniture.h"
#include "mapping/world/semantic_map.h"
#include "mapping/world/world.h"

namespace loci::mapping {

/// Writes a front as links, joints and sidecar entries below `parent` (§7.5); every link with geometry has
/// visual, collision and inertia, joint names are LINK_joint, 0 is closed.
///  - A drawer NAME becomes the prototype: NAME_front (the front's frame) under one prismatic joint, fixed to
///    it NAME_left, NAME_right, NAME_back, NAME_bottom (a support) and NAME_handle or NAME_knob. Left is left
///    as seen from the furniture, +y of the front's frame.
///  - A door or flap NAME is the link NAME whose frame has the origin in the hinge, under a revolute joint;
///    NAME_front is the front's frame without geometry, and carries NAME_handle or NAME_knob.
///  - A front without joint, or with a rigid one, is the link NAME, fixed, in the front's frame.
/// Unknown limits (upper = lower) become usual ones. Nothing of it penetrates what is there already: see
/// fit_fronts(), cut_supports(), limit_joints(). Error for a front without name or size,
/// or whose name is taken.
void add_front(const Front& front, const std::string& parent, World& world, SemanticMap& semantics);

/// The same for several fronts, which make room for each other.
void add_fronts(const std::vector<Front>& fronts, const std::string& parent, World& world,
                SemanticMap& semantics);

/// Removes a front's links, joints and entries. Error when there is no front of this name.
void remove_front(const std::string& name, World& world, SemanticMap& semantics);

/// The link that carries a front's sidecar entry and moves, by the front's base name ("drawer_3" →
/// "drawer_3_front", "door_2" → "door_2"); unset when the map has no such front.
std::optional<std::string> front_link(const std::string& name, const SemanticMap& semantics);

/// The fronts of a map in the order of their links' names, written by add_front() or by other tools:
/// rectangle, fixture and evidence from the sidecar, joint from the URDF. Error for a sidecar entry with
/// missing fields.
std::vector<Front> fronts_of(const World& world, const SemanticMap& semantics);

}  // namespace loci::mapping
