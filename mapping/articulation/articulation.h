#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "mapping/base/json_fwd.h"
#include "mapping/base/options.h"
#include "mapping/sensor/scan.h"
#include "mapping/world/furniture.h"

namespace loci::mapping {

/// How the joint of a front is most likely made, from its shape and where its handle is (§7.4): handle along
/// the top or middle of a wide front = drawer; upright near one edge = door hinged at the other; along the
/// top of a tall low front = flap. Without a fixture the type is open: probabilities say so.
/// The axis, hinge and limits are those of the most probable mounting of the most probable type; where
/// another mounting of that type may be meant (hinge on the other side), the uncertainties contain it. A
/// known `front.appliance` counts (an oven has a flap).
JointEstimate joint_prior(const Front& front);

/// Logarithm of the density of fronts of this size with their fixture there, over all mountings of the same
/// model: which of several rectangles around a handle is the likeliest front. Its scale is arbitrary.
double front_log_likelihood(const Front& front);

/// What a front that moves so is called: "drawer", "door" (upright hinge), "flap" (level hinge); "front" when
/// it does not move.
std::string front_class(const Front& front, const JointEstimate& joint);

/// A recorded motion: positions, and orientations where they were measured.
struct Track {
  std::vector<Vector3d> positions;               ///< metres, in the order of recording
  std::vector<Eigen::Quaterniond> orientations;  ///< empty, or one per position
};

/// Reads a CSV with columns x, y, z and, where there are orientations, qx, qy, qz, qw; others are ignored.
/// Error with line and column for what is missing, not a finite number, or a quaternion not of unit length.
Track read_track(const std::filesystem::path& csv);

struct TrackOptions {
  double position_sigma_m = 0;       ///< 0 = estimated from the track
  double orientation_sigma_deg = 0;  ///< 0 = estimated
  double outlier_probability = 0.05;

  void declare(OptionTable& table);
};

/// One model fitted to a track.
struct TrackFit {
  JointEstimate::Type type = JointEstimate::Type::rigid;
  Vector3d axis = Vector3d::UnitZ(), centre = Vector3d::Zero();
  double radius = 0;
  double rms_m = 0;           ///< distance from the path of what is no outlier
  double log_likelihood = 0;  ///< as of `TrackResult::effective_poses` independent poses
  double bic = 0;             ///< parameters · ln(effective poses) − 2 · log likelihood
  size_t parameters = 0, outliers = 0;
  std::vector<double> positions;  ///< of the joint at each pose, metres or radians
};

struct TrackResult {
  JointEstimate estimate;      ///< in the track's frame; probabilities are even when not usable
  std::vector<TrackFit> fits;  ///< rigid, prismatic, revolute
  bool usable = false;
  std::string reason;              ///< why not, or what limits it: "neither line nor circle fits"
  double unknown_probability = 0;  ///< that neither of the three explains the track
  double effective_poses = 0;      ///< as many independent poses say as much (errors of a path hang together)
  double sigma_m = 0;              ///< noise per direction, as given or estimated
  double misfit_m = 0;             ///< by how much the smoothed track leaves the best path

  /// rigid, prismatic, revolute, or unknown.
  std::string type_name() const;
  std::string summary() const;
  Json report() const;
};

/// Which joint made a track (after Sturm et al., "A probabilistic framework for learning kinematic models of
/// articulated objects", JAIR 2011): point, line and circle are fitted with outliers, and compared by their
/// likelihood with a penalty for parameters (BIC). Errors of recorded paths hang together, so that they count
/// as fewer poses; what a hand's path bends by is tolerated before a line is called an arc; where neither
/// fits the type is unknown. Orientations, where there are any, must turn with the arc or stay. Error for
/// fewer than three poses, values that are not finite, or orientations that do not match in number.
TrackResult fit_track(const Track& track, const TrackOptions& options);

struct DifferenceOptions {
  double tolerance_m = 0.03;             ///< nearer to what was there before is no change
  double hand_position_sigma_m = 0.001;  ///< noise of the hand's poses, per direction
  double hand_orientation_sigma_deg = 0.3;

  void declare(OptionTable& table);
};

struct DifferenceResult {
  std::optional<JointEstimate> joint;  ///< unset: no motion was seen, or it cannot be explained; see reason
  bool moves_otherwise = false;        ///< it moved, but as none of the joints explains: a folding door
  double moved = 0;                    ///< joint position of `after`, metres or radians
  std::optional<Front> corrected;      ///< the front's rectangle by the outline of what moved
  size_t points = 0;                   ///< of the moved part
  std::string reason;
  Json report() const;
};

/// What moved between two scan sets in one map frame, near the front that was pulled: segments the temporal
/// difference, seeks the face that slid or turned, and fits the joint to it and to `hand_path` (where the
/// gripper was, closed first; may be empty), each by its noise. Which type it is follows from the front's
/// shape, the hand's path, and how much of the front is seen where the type puts it. A hinge farther outside
/// the front than it is wide is none: then the joint stays unknown.
DifferenceResult articulate(const ScanSet& before, const ScanSet& after, const Front& front,
                            const std::vector<Isometry3d>& hand_path, const DifferenceOptions& options);

}  // namespace loci::mapping
