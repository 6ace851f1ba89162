#pragma once

#include "mapping/world/furniture.h"
#include "mapping/world/semantic_map.h"
#include "mapping/world/world.h"

namespace loci {

/// Writes a front as links, joints and sidecar entries below `parent`: a drawer as the prototype of §7.5
/// (front, two sides, back, bottom, handle under one prismatic joint), a door or flap under its hinge, a
/// front without joint fixed; every link with visual, collision and inertia. Joint names are LINK_joint.
void add_front(const Front& front, const std::string& parent, World& world, SemanticMap& semantics);

/// Takes a front's links, joints and entries out again; what it gets instead keeps its name.
void remove_front(const std::string& name, World& world, SemanticMap& semantics);

/// The fronts of a map, as add_front() wrote them or as other tools' URDF with a sidecar tells.
std::vector<Front> fronts_of(const World& world, const SemanticMap& semantics);

}  // namespace loci
