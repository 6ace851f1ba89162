#pragma once

#include <vector>

#include "mapping/base/math/pose.h"
#include "mapping/interpretation/interpretation.h"
#include "mapping/interpretation/surfaces/surface.h"

namespace loci::mapping {

/// Hough votes of vertical surfels for their lines in the ground plan, by angle of the normal and offset.
/// Each surfel votes for angles near its own normal only.
class LineVotes {
 public:
  struct Bins {
    int angles = 120;  ///< over the full turn
    int spread = 2;    ///< bins to each side of a surfel's own angle that it votes for
    double offset_m = 0.03;
  };

  /// `reach`: metres from the origin to the farthest surfel that will vote.
  LineVotes(double reach, const Bins& bins);

  void vote(const Vector2d& position, const Vector2d& normal, int amount);

  struct Peak {
    Vector2d normal;
    double offset = 0;
    int votes = 0;
    size_t bin = 0;
  };
  Peak strongest() const;
  /// Removes the votes of a peak.
  void forget(const Peak& peak) { votes_[peak.bin] = 0; }

 private:
  Vector2d direction(int angle) const;

  Bins bins_;
  double step_;
  int offsets_;
  std::vector<int> votes_;
};

/// A vertical plane: normal · (x, y) = offset, with the rectangle in which it was seen.
struct VerticalPlane {
  Vector2d normal = Vector2d::UnitX();  ///< towards the side it was seen from
  double offset = 0;
  double along_min = 0, along_max = 0;  ///< along (-normal.y, normal.x), metres
  double bottom = 0, top = 0;           ///< z
  double area = 0;                      ///< seen, m²
  double sd = 0;                        ///< of the distances of its points, metres
  double behind = 0;                    ///< fraction of its length behind which something was seen
  size_t inliers = 0;
  std::vector<int> scans;

  Vector2d direction() const { return {-normal.y(), normal.x()}; }
  double length() const { return along_max - along_min; }
  /// A point of the plane at a position along it.
  Vector2d at(double along) const { return offset * normal + along * direction(); }
};

/// The mean of the points in a small cube.
struct Surfel {
  Vector3d position = Vector3d::Zero();
  Vector3d normal = Vector3d::Zero();  ///< unit; zero = no surface
  size_t count = 0;
  std::vector<uint16_t> scans;
  bool taken = false;

  bool vertical() const { return normal.squaredNorm() > 0.5 && std::abs(normal.z()) < 0.25; }
};

/// The points, averaged per small cube.
std::vector<Surfel> surfels_of(const Surface& surface);

/// A vertical plane with its inliers.
struct PlanePatch {
  VerticalPlane plane;
  std::vector<size_t> surfels;
};

/// Vertical planes by Hough votes, largest first, each split at wide gaps; pieces of less than half a wall's
/// minimum area are dropped.
std::vector<PlanePatch> vertical_planes(std::vector<Surfel>& surfels, const InterpretationOptions& options);

/// One plane through the surfels of two patches.
PlanePatch united(const std::vector<Surfel>& surfels, const PlanePatch& a, const PlanePatch& b);

}  // namespace loci::mapping
