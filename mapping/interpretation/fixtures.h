#pragma once

#include <string>
#include <vector>

#include "mapping/base/random.h"
#include "mapping/interpretation/face_raster.h"
#include "mapping/world/furniture.h"

namespace loci::mapping {

/// A handle or knob before a face.
struct FaceFixture {
  Fixture fixture;  ///< map frame
  double u = 0, v = 0;
  FaceRect box;  ///< what it covers of the face
};

struct FixtureSearch {
  std::vector<FaceFixture> fixtures;
  std::vector<std::string> notes;  ///< why not
};

/// Clusters that stand 1.5 to 9 cm before a face with free space around them (§7.4): sample consensus with a
/// line gives a handle, with a circle a knob; what is too thick, too long, at the border of the face, seen
/// from one side only or spread in depth (mixed returns at the edge of something farther before the face)
/// is none.
FixtureSearch find_fixtures(const FaceRays& rays, const Random& random);

}  // namespace loci::mapping
