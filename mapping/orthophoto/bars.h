#pragma once

#include <vector>

#include "mapping/interpretation/fronts/fixtures.h"
#include "mapping/orthophoto/orthophoto.h"

namespace loci::mapping {

/// Bars before a face: thin, straight, level or upright parts of the orthophoto that differ from the face on
/// both sides and end within it. A depth camera rarely resolves them: their distance from the face is that of
/// the relief where it shows one, otherwise the usual. `u`, `v` and `box` are where the orthophoto shows
/// them, the centre is in the map. Confidence is by contrast.
std::vector<FaceFixture> find_bars(const Orthophoto& photo);

}  // namespace loci::mapping
