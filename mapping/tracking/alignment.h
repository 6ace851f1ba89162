#pragma once

#include <span>
#include <string>

#include "mapping/base/math/pose.h"
#include "mapping/tracking/keyframe.h"

namespace loci::mapping::tracking {

/// A keyframe and where it is.
struct Reference {
  const Keyframe* keyframe = nullptr;
  Isometry3d map_from_keyframe = Isometry3d::Identity();
};

/// Where a frame is as seen from keyframes, and how well that is known.
struct Alignment {
  Isometry3d map_from_camera = Isometry3d::Identity();
  Matrix6d information = Matrix6d::Zero();  ///< of a small motion (translation, rotation) in the camera frame
  Matrix6d hessian = Matrix6d::Zero();      ///< of the residuals, noise of the normals left in
  size_t compared = 0;                      ///< model points whose depth can be compared
  size_t inliers = 0;                       ///< of them, those that agree
  double rms = 0;                           ///< m, of the inliers
  double intensity_error = 0;               ///< mean absolute, logarithmic scale; 0 without colour

  double inlier_share() const {
    return compared == 0 ? 0 : static_cast<double>(inliers) / static_cast<double>(compared);
  }
  /// From the information; nothing when the pose is not determined in all directions.
  std::optional<Matrix6d> covariance() const;
};

/// Which levels an alignment passes through, coarsest first.
struct LevelRange {
  size_t coarsest = 3;
  size_t finest = 0;
};

/// What is known of a pose before the images are compared.
struct PosePrior {
  Isometry3d map_from_camera = Isometry3d::Identity();
  Vector6d sigma = Vector6d::Zero();  ///< of a small motion (translation, rotation) in the camera frame
};

/// Aligns a frame with keyframes at once: projective point-to-plane distances and differences of intensity of
/// model points that are projected into the frame, by robust Gauss-Newton steps from coarse to fine. A prior
/// decides where they do not determine the pose; the information of the result is without it.
Alignment align(const FrameImages& frame, std::span<const Reference> references, const Isometry3d& guess,
                const LevelRange& levels = {}, const PosePrior* prior = nullptr);

/// How well a pose fits without moving it, on one level.
Alignment compare(const FrameImages& frame, std::span<const Reference> references, const Isometry3d& pose,
                  size_t level);

/// The part of a keyframe's points that a frame at this pose would see.
double overlap(const FrameImages& frame, const Reference& reference, const Isometry3d& map_from_camera);

/// The part of a frame's surfaces that the keyframes saw through, plus that of theirs that the frame sees
/// through: at the right pose in a scene at rest there are none. What is hidden or out of view does not
/// count.
double contradiction(const FrameImages& frame, std::span<const Reference> references,
                     const Isometry3d& map_from_camera);

/// Why the images do not fit at the pose of an alignment; empty when they do.
std::string misfit_of(const Alignment& alignment, double min_inliers);
/// Whether what is in view determines the pose in all directions.
bool is_determined(const Alignment& alignment);

/// The inverse of small_motion.
Vector6d vector_of(const Isometry3d& motion);

/// The motion with translation and rotation vector `v`, to the first order.
Isometry3d small_motion(const Vector6d& v);

}  // namespace loci::mapping::tracking
