#pragma once

#include <vector>

#include "mapping/articulation/moved_face.h"
#include "mapping/world/furniture.h"

namespace loci::mapping {

/// Evidence about a part that moved. Faces and hand are optional. `expected_axis` is a prior: a drawer runs
/// along its front's normal, a hinge along an edge, within some degrees.
struct MotionEvidence {
  const FittedPlane* closed = nullptr;
  const FittedPlane* open = nullptr;        ///< with `closed`
  Vector3d face_centre = Vector3d::Zero();  ///< of the closed face
  std::vector<Isometry3d> hand_path;        ///< of a hand that holds the fixture, closed first
  double hand_position_sigma_m = 0.001, hand_orientation_sigma_deg = 0.3;
  Vector3d expected_axis = Vector3d::UnitX();
};

/// The joint that explains hand and faces best: least squares over joint, grip and the joint position at
/// every pose of the hand, each measurement weighted by its noise. Residuals of the hand beyond its noise
/// increase the uncertainties. `start` holds the type and initial values.
Motion fit_motion(const Motion& start, const MotionEvidence& evidence);

}  // namespace loci::mapping
