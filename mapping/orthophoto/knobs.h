#pragma once

#include <vector>

#include "mapping/interpretation/fronts/fixtures.h"
#include "mapping/orthophoto/orthophoto.h"

namespace loci::mapping {

/// Knobs before a face: round spots that a layer before it shows clearer than the face does, or whose relief
/// stands out, with the face around them. `bars` are known already: knobs are not sought at them. Confidence
/// is by contrast.
std::vector<FaceFixture> find_knobs(const Orthophoto& photo, const std::vector<FaceFixture>& bars);

}  // namespace loci::mapping
