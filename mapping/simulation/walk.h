#pragma once

#include <filesystem>
#include <vector>

#include "mapping/base/error.h"
#include "mapping/base/math/pose.h"
#include "mapping/base/math/random.h"
#include "mapping/base/time.h"
#include "mapping/simulation/record.h"
#include "mapping/world/mesh.h"
#include "mapping/world/world.h"

namespace loci::mapping {

/// Places inside a closed world, 0.8 m apart, where a person can stand, in the order of a walk. Error when
/// there is none.
std::vector<Vector2d> standing_places(const World& world, const MeshSearch& search, Warnings& warnings);

/// Camera poses (optical frame, map frame) of a person who stands at each place and turns round in steps of
/// 30 degrees, with the camera held low and high: what furniture shows to the floor is seen from one metre or
/// two, from several sides.
std::vector<Isometry3d> views_from(const std::vector<Vector2d>& places);

/// Camera poses at 30 Hz of a person who goes from place to place, a little beside each, and turns round
/// there: a path that a camera can be tracked on.
std::vector<Isometry3d> stroll(const std::vector<Vector2d>& places, Random& random);

/// A recording of a world (URDF) by a simulated Kinect with true poses. A world without a link `floor` gets
/// one at 0.
RecordResult record_views(const std::filesystem::path& world, std::vector<Isometry3d> map_from_camera,
                          TimeNs frame_interval, const std::filesystem::path& folder,
                          const RecordOptions& options, Progress& progress, Warnings& warnings);

}  // namespace loci::mapping
