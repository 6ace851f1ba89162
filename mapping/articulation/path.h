#pragma once

#include <array>
#include <vector>

#include "mapping/base/pose.h"

namespace loci::mapping {

/// The path of a point on a moving part: it stays, or runs along a line or a circle.
struct Path {
  enum class Kind { point, line, circle };
  Kind kind = Kind::point;
  Vector3d centre = Vector3d::Zero();  ///< the point, a point of the line, the circle's centre
  Vector3d axis = Vector3d::UnitZ();   ///< along the line; through the circle's centre, along its normal
  double radius = 0;

  /// How far a position is off the path: three components for a point, two (the third is zero) otherwise
  /// (circle: radially, along the axis).
  Vector3d across(const Vector3d& position) const;
  int across_dimensions() const { return kind == Kind::point ? 3 : 2; }
  /// Free parameters: 3, 4, 6.
  int parameters() const;
  /// Joint positions along the path (metres, radians without jumps at π), relative to the first whose weight
  /// says that it is no outlier.
  std::vector<double> along(const std::vector<Vector3d>& positions, const std::vector<double>& weights) const;
};

/// A path fitted by expectation maximisation to positions of which some are outliers: what is off the path is
/// normal with `sigma` per direction, or, with probability `outlier_share`, anywhere in the track's box.
struct PathFit {
  Path path;
  double sigma = 0;  ///< metres, per direction
  double outlier_share = 0;
  std::vector<double> weights;  ///< probability that a pose is no outlier
  std::vector<double> along;    ///< joint position at each pose
  double travel = 0;            ///< length of the path, metres, over what is no outlier
  double span = 0;              ///< metres over which poses are taken to be spread along the path
  double rms = 0;               ///< weighted distance from the path, metres
  double log_likelihood = 0;    ///< of all poses, as if they were independent
  Eigen::MatrixXd covariance;   ///< of the parameters of perturbed(), as if independent

  size_t outliers() const;
};

struct PathOptions {
  double sigma = 0;  ///< metres; 0 = estimated
  double outlier_probability = 0.05;
  double span = 0;  ///< metres over which poses are spread along the path; 0 = as fitted. Equal for paths
                    ///< that are compared.
};

/// Fits one kind of path; at least as many positions as the kind needs (1, 2, 3), finite.
PathFit fit_path(Path::Kind kind, const std::vector<Vector3d>& positions, const PathOptions& options);

/// The path after a small change of its parameters: line: centre along two normals, axis towards them;
/// circle: centre (along two normals and the axis), axis towards the normals, radius.
Path perturbed(const Path& path, const Eigen::VectorXd& change);

/// Two directions that are normal to `axis` and to one another.
std::array<Vector3d, 2> normals_of(const Vector3d& axis);

}  // namespace loci::mapping
