#pragma once

#include <vector>

#include "mapping/interpretation/interpretation.h"
#include "mapping/interpretation/surface.h"
#include "mapping/interpretation/walls.h"

namespace loci::mapping {

/// A small piece of surface.
struct Surfel {
  Vector3d position = Vector3d::Zero();
  Vector3d normal = Vector3d::Zero();  ///< unit; zero = no surface
  size_t count = 0;
  std::vector<uint16_t> scans;
  bool taken = false;

  bool vertical() const { return normal.squaredNorm() > 0.5 && std::abs(normal.z()) < 0.25; }
};

/// The points thinned to one per small cube.
std::vector<Surfel> surfels_of(const Surface& surface);

/// A vertical plane with the surfels that it rests on.
struct PlanePatch {
  VerticalPlane plane;
  std::vector<size_t> surfels;
};

/// Vertical planes by votes for angle and offset, largest first, each parted where there is a wide gap along
/// it; pieces of less than half the least area of a wall are dropped.
std::vector<PlanePatch> vertical_planes(std::vector<Surfel>& surfels, const InterpretationOptions& options);

/// One plane through the surfels of two patches.
PlanePatch united(const std::vector<Surfel>& surfels, const PlanePatch& a, const PlanePatch& b);

}  // namespace loci::mapping
