#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <opencv2/core.hpp>
#include <vector>

#include "perception/annotators/segmentation/clustering/part_assembly.h"
#include "perception/annotators/structure/supports.h"

namespace loci::perception {

/// What a camera sees of an upright object between two heights, from left to right.
struct OutlineBand {
  int points = 0;      ///< that it was measured on
  float width = 0;     ///< between the outermost points to the left and to the right, metres
  float distance = 0;  ///< of the mean from the viewpoint, in the plane, metres
  Eigen::Vector2f middle = Eigen::Vector2f::Zero();  ///< between those two points, in the plane
  Eigen::Vector2f across = Eigen::Vector2f::Zero();  ///< unit vector to the left in the image
};

/// The band between the heights `low` and `high` of the points `members` of a cloud over a support (z =
/// height, metres), as seen from `viewpoint`. Of the outermost points 2 % on either side are left out.
OutlineBand outline_band(const std::vector<Eigen::Vector3f>& cloud, const std::vector<int>& members,
                         const Eigen::Vector2f& viewpoint, float low, float high);

/// One or several parts that are taken for one object so far.
struct Piece {
  std::vector<int> points;
  double area = 0;                                ///< m², as seen
  double noise = 1;                               ///< of the depth relative to that at 1 m
  Eigen::Vector3f lab = Eigen::Vector3f::Zero();  ///< mean colour
  float bottom = 0;
  float top = 0;
  std::vector<cv::Point2f> footprint;  ///< convex, completed by reflection
  PolygonOutline outline;              ///< the same
  Eigen::AlignedBox2f extent;          ///< of the footprint
  float distance = 0;                  ///< of the mean from the viewpoint, in the plane
  float bearing = 0;                   ///< of the mean as seen from there, radians
  float left = 0, right = 0;           ///< angles between which it is seen, from the bearing
  float facing_out = 0;                ///< whether its walls face its middle (-1) or away from it (1)
};

/// Area, noise and colour, which joining splinters goes by.
void measure_area(Piece& piece, const PlaneCloud& cloud);
/// All but those: heights, footprint, where it is seen, where its walls face.
void measure_shape(Piece& piece, const PlaneCloud& cloud);

/// Root mean square distance of two pieces from the plane that fits both best, each counting alike; the
/// larger one of the two.
double plane_residual(const Piece& a, const Piece& b, const PlaneCloud& cloud);

/// How much of `b` lies on the open side of how much of `a`: of a convex object all lies behind each of its
/// outer walls. What is level or faces inwards has no open side here.
double share_before(const Piece& a, const Piece& b, const PlaneCloud& cloud, double slack_m);

/// A piece as a straight rod that lies on the support, as thick as it is seen to be.
struct Rod {
  Eigen::Vector2f middle, along;  ///< unit vector
  float length = 0, thickness = 0, height = 0;

  Rod(const Piece& piece, const PlaneCloud& cloud);
  /// Longer than thick and high, and about as high as thick: boxes that lie beside each other and cups are
  /// not.
  bool is_rod() const;
  /// Between the nearest ends, metres.
  float gap_to(const Rod& other) const;
};

}  // namespace loci::perception
