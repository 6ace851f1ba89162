#pragma once

#include <optional>
#include <vector>

#include "mapping/interpretation/fronts/furniture_face.h"
#include "mapping/recording/recording.h"

namespace loci::mapping {

/// Pose of a frame's depth camera in a face's coordinates (u, v, depth).
Isometry3d face_from_camera(const FurnitureFace& face, const Isometry3d& map_from_camera);

/// A measured point in a face's coordinates, metres.
struct FacePoint {
  double u, v, depth;
};

/// Points of a frame near the face.
std::vector<FacePoint> points_near(const RgbdFrame& frame, const Isometry3d& face_from_camera,
                                   const FurnitureFace& face);

/// The parts of a face between upright steps of its surface, as between a tall cupboard and the counter
/// beside it: each is a plane of its own. Single frames show the steps, so that drift between frames makes
/// none. The face itself where there are none. `map_from_camera`: by frame; unset = not used.
std::vector<FurnitureFace> divided_at_steps(const Recording& recording,
                                            const std::vector<std::optional<Isometry3d>>& map_from_camera,
                                            const FurnitureFace& face, int threads);

}  // namespace loci::mapping
