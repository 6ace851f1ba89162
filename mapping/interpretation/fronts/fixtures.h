#pragma once

#include <string>
#include <vector>

#include "mapping/base/math/random.h"
#include "mapping/interpretation/fronts/face.h"
#include "mapping/world/furniture.h"

namespace loci::mapping {

/// A handle or knob before a face.
struct FaceFixture {
  Fixture fixture;  ///< map frame
  double u = 0, v = 0;
  FaceRect box;  ///< extent on the face
};

struct FixtureSearch {
  std::vector<FaceFixture> fixtures;
  std::vector<Fixture> ribs;       ///< bars that stand in a row, too near to each other for handles
  std::vector<std::string> notes;  ///< why other clusters are no fixtures
};

/// Clusters 1.5 to 11 cm before a face with free space around them (§7.4): sample consensus with a line
/// yields a handle, with a circle a knob. Clusters that are too thick or too long, at the border of the face,
/// seen from one side only or spread in depth (mixed returns at edges of objects farther before the face) are
/// rejected.
FixtureSearch find_fixtures(const FaceRays& rays, const Random& random);

}  // namespace loci::mapping
