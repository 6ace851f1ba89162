#pragma once

#include <array>
#include <vector>

#include "mapping/base/math/pose.h"

namespace loci::mapping {

/// The path of a point on a moving part: a point, a line or a circle.
struct Path {
  enum class Kind { point, line, circle };
  Kind kind = Kind::point;
  Vector3d centre = Vector3d::Zero();  ///< the point, a point of the line, the circle's centre
  Vector3d axis = Vector3d::UnitZ();   ///< along the line; through the circle's centre, along its normal
  double radius = 0;

  /// Residual of a position: three components for a point, otherwise two and a zero (circle: radial, along
  /// the axis).
  Vector3d across(const Vector3d& position) const;
  int across_dimensions() const { return kind == Kind::point ? 3 : 2; }
  /// Free parameters: 3, 4, 6.
  int parameters() const;
  /// Joint positions along the path (metres, radians without jumps at π), relative to the first inlier.
  std::vector<double> along(const std::vector<Vector3d>& positions, const std::vector<double>& weights) const;
};

/// A path fitted by expectation maximisation: residuals are normal with `sigma` per direction or, with
/// probability `outlier_share`, positions are uniform in the track's box.
struct PathFit {
  Path path;
  double sigma = 0;  ///< metres, per direction
  double outlier_share = 0;
  std::vector<double> weights;  ///< probability that a pose is an inlier
  std::vector<double> along;    ///< joint position at each pose
  double travel = 0;            ///< length of the path over inliers, metres
  double span = 0;              ///< assumed spread of poses along the path, metres
  double rms = 0;               ///< weighted distance from the path, metres
  double log_likelihood = 0;    ///< of all poses, as if independent
  Eigen::MatrixXd covariance;   ///< of the parameters of perturbed(), as if independent

  size_t outliers() const;
};

struct PathOptions {
  double sigma = 0;  ///< metres; 0 = estimated
  double outlier_probability = 0.05;
  double span = 0;  ///< spread of poses along the path, metres, equal for compared paths; 0 = as fitted
};

/// Fits one kind of path; at least as many positions as the kind needs (1, 2, 3), finite.
PathFit fit_path(Path::Kind kind, const std::vector<Vector3d>& positions, const PathOptions& options);

/// The path after a small change of its parameters: line: centre along two normals, axis towards them;
/// circle: centre (along two normals and the axis), axis towards the normals, radius.
Path perturbed(const Path& path, const Eigen::VectorXd& change);

/// Two directions that are normal to `axis` and to one another.
std::array<Vector3d, 2> normals_of(const Vector3d& axis);

/// The number of independent values that say as much as these residuals: their number over the sum of their
/// autocorrelation up to where it vanishes.
double effective_count(const std::vector<Vector3d>& residuals);

/// How well measured orientations rotate with a joint about an axis.
struct OrientationFit {
  Eigen::Quaterniond start = Eigen::Quaterniond::Identity();  ///< orientation at joint position 0
  std::vector<double> angles;                                 ///< radians off, per pose that counts
  double sigma = 0;                                           ///< per direction, robust
  double effective_poses = 0;                                 ///< errors of orientations are correlated

  /// As of `poses` independent orientations with noise `noise` per direction (radians) and outliers.
  double log_likelihood(double noise, double poses) const;
};

/// Robust fit of the orientation at joint position 0; poses with weights below one half do not count.
OrientationFit fit_orientations(const std::vector<Eigen::Quaterniond>& orientations, const Vector3d& axis,
                                const std::vector<double>& joint_positions,
                                const std::vector<double>& weights);

}  // namespace loci::mapping
