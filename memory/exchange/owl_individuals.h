#pragma once

#include <string>

#include "memory/questions/location.h"

namespace loci::memory {

/// The objects of a memory as OWL individuals with time, with the names of KnowRob that the map's export has
/// (mapping/exchange/formats/owl.h): every object is a HumanScaleObject with its size, what it was called and
/// what people named it; every stay is a SemanticMapPerception of it with startTime, endTime and a pose
/// (RotationMatrix3D, position only), where the object is on or in (inRegion, the map's individual of that
/// name) and how probable that is. `name` becomes part of the namespace.
std::string owl_individuals(const Store& store, const std::string& name, const AsOf& as_of = {});

}  // namespace loci::memory
