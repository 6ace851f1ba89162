#pragma once

#include <string>

#include "mapping/world/semantic_map.h"
#include "mapping/world/world.h"

namespace loci::mapping {

/// A map as OWL-DL in RDF/XML, as the semantic maps of KnowRob are written: every link with a sidecar entry
/// is an individual of its own name with class, size, pose (a SemanticMapPerception with a RotationMatrix3D)
/// and parts, every joint that moves a HingedJoint or PrismaticJoint. The classes and properties that are
/// used are declared, so that the file can be read without KnowRob. `name` becomes part of the namespace;
/// `time_ns` is when the map was made.
std::string owl_text(const World& world, const SemanticMap& semantics, const std::string& name,
                     int64_t time_ns);

/// The class of a link: "Drawer" for a drawer, "Refrigerator" for what carries the appliance "fridge".
std::string knowrob_class(const SemanticLink& link);

}  // namespace loci::mapping
