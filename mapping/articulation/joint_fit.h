#pragma once

#include <vector>

#include "mapping/articulation/face.h"
#include "mapping/world/furniture.h"

namespace loci::mapping {

/// How a part moved: the joint, and its position where it was seen open.
struct Motion {
  JointEstimate::Type type = JointEstimate::Type::rigid;
  Vector3d axis = Vector3d::UnitX(), origin = Vector3d::Zero();
  double position = 0;
  double axis_sd_deg = 0, origin_sd_m = 0;

  Isometry3d moved_from_closed() const;
};

/// What is known of a part that moved. Faces may be left out, and so may the hand; what the habits of joints
/// say (`habitual_axis`: a drawer runs along its front's normal, a hinge along an edge, within some degrees)
/// counts with the rest.
struct MotionEvidence {
  const Face* closed = nullptr;
  const Face* open = nullptr;               ///< with `closed`
  Vector3d face_centre = Vector3d::Zero();  ///< of the closed face
  std::vector<Isometry3d> hand_path;        ///< held fast all the way, closed first
  double hand_position_sigma_m = 0.001, hand_orientation_sigma_deg = 0.3;
  Vector3d habitual_axis = Vector3d::UnitX();
};

/// The drawer or door that explains hand and faces best: least squares over joint, grip and the joint's
/// position at every pose of the hand, each measurement weighed by its noise. What the hand strays by beyond
/// its noise widens the uncertainties. `start` has the type and where to begin.
Motion fit_motion(const Motion& start, const MotionEvidence& evidence);

}  // namespace loci::mapping
