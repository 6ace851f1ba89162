#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "mapping/base/options.h"
#include "mapping/base/text/json_fwd.h"
#include "mapping/sensor/scan.h"
#include "mapping/world/furniture.h"

namespace loci::mapping {

/// Prior of a front's joint by its shape and the position of its handle (§7.4): handle along the top or
/// middle of a wide front = drawer; upright near one edge = door hinged at the other; along the top of a tall
/// low front = flap. Without a fixture the probabilities are nearly even. Axis, hinge and limits are those of
/// the most probable mounting of the most probable type; the uncertainties include its other mountings (hinge
/// on the other side). A known `front.appliance` counts (an oven has a flap).
JointEstimate joint_prior(const Front& front);

/// The same with the most probable mounting of a given type, which something else shows; the probabilities
/// are those of the shape.
JointEstimate joint_prior(const Front& front, ArticulationType type);

/// Log density of fronts of this size with this fixture over all mountings, up to a constant: compares
/// possible rectangles around a handle.
double front_log_likelihood(const Front& front);

/// The class of a front by its joint: "drawer", "door" (upright hinge, or sliding along its plane), "flap"
/// (level hinge), "front" (rigid).
std::string front_class(const Front& front, const JointEstimate& joint);

/// A recorded motion: positions, and orientations where they were measured.
struct Track {
  std::vector<Vector3d> positions;               ///< metres, in the order of recording
  std::vector<Eigen::Quaterniond> orientations;  ///< empty, or one per position
};

/// Reads a CSV with columns x, y, z and, where there are orientations, qx, qy, qz, qw; others are ignored.
/// Error with line and column for missing or non-finite values and for quaternions not of unit length.
Track read_track(const std::filesystem::path& csv);

struct TrackOptions {
  double position_sigma_m = 0;       ///< 0 = estimated from the track
  double orientation_sigma_deg = 0;  ///< 0 = estimated
  double outlier_probability = 0.05;

  void declare(OptionTable& table);
};

/// One model fitted to a track.
struct TrackFit {
  ArticulationType type = ArticulationType::rigid;
  Vector3d axis = Vector3d::UnitZ(), centre = Vector3d::Zero();
  double radius = 0;
  double rms_m = 0;           ///< distance of inliers from the path
  double log_likelihood = 0;  ///< of `TrackResult::effective_poses` independent poses
  double bic = 0;             ///< parameters · ln(effective poses) − 2 · log likelihood
  size_t parameters = 0, outliers = 0;
  std::vector<double> positions;  ///< of the joint at each pose, metres or radians
};

struct TrackResult {
  JointEstimate estimate;      ///< in the track's frame; probabilities are even when not usable
  std::vector<TrackFit> fits;  ///< rigid, prismatic, revolute
  bool usable = false;
  std::string reason;              ///< why not usable or uncertain: "neither line nor circle fits"
  double unknown_probability = 0;  ///< that none of the three explains the track
  double effective_poses = 0;      ///< number of independent poses: errors along a path are correlated
  double sigma_m = 0;              ///< noise per direction, as given or estimated
  double misfit_m = 0;             ///< deviation of the smoothed track from the best path

  /// rigid, prismatic, revolute, or unknown.
  std::string type_name() const;
  std::string summary() const;
  Json report() const;
};

/// The joint that generated a track (after Sturm et al., "A probabilistic framework for learning kinematic
/// models of articulated objects", JAIR 2011): fits point, line and circle with outliers and compares their
/// likelihoods with a penalty for parameters (BIC). Correlated errors count as fewer poses; usual bends of a
/// hand's path are no arc; where neither line nor circle fits, the type is unknown. Orientations, if any,
/// must rotate with the arc or stay. Error for fewer than three poses, non-finite values, or a different
/// number of orientations.
TrackResult fit_track(const Track& track, const TrackOptions& options);

struct DifferenceOptions {
  double tolerance_m = 0.03;             ///< smaller distances from the earlier surface are no change
  double hand_position_sigma_m = 0.001;  ///< noise of the hand's poses, per direction
  double hand_orientation_sigma_deg = 0.3;

  void declare(OptionTable& table);
};

struct DifferenceResult {
  std::optional<JointEstimate> joint;  ///< unset: no motion, or an unexplained one; see reason
  bool unexplained_motion = false;     ///< it moved, but like none of the joints: a folding door
  double moved = 0;                    ///< joint position of `after`, metres or radians
  std::optional<Front> corrected;      ///< the front's rectangle by the outline of the moved part
  size_t points = 0;                   ///< of the moved part
  std::string reason;
  Json report() const;
};

/// How scans show the closed fronts of a map. A front is there where points lie on its face, and is looked
/// through where rays passed its face.
struct MapFit {
  size_t there = 0, looked_through = 0, unseen = 0;  ///< fronts
  /// Whether the scans can be of the map's kitchen, in its frame.
  bool plausible() const { return there > looked_through; }
};
MapFit fit_to_map(const ScanSet& scans, const std::vector<Front>& fronts, const DifferenceOptions& options);

/// The motion between two scan sets in one map frame near the front that was pulled: segments the temporal
/// difference, searches for the face that slid or rotated, and fits the joint to it and to `hand_path` (poses
/// of the gripper, closed first; may be empty), weighted by their noise. The type follows from the front's
/// shape, the hand's path, and the share of the front that is seen where the type predicts it. The joint
/// stays unknown if the hinge is farther outside the front than the front is wide.
DifferenceResult articulate(const ScanSet& before, const ScanSet& after, const Front& front,
                            const std::vector<Isometry3d>& hand_path, const DifferenceOptions& options);

}  // namespace loci::mapping
