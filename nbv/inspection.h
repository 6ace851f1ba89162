#pragma once

#include <functional>
#include <vector>

#include "mapping/occupancy/occupancy.h"
#include "mapping/sensor/scan.h"
#include "nbv/planner.h"

namespace loci::nbv {

struct InspectionOptions {
  double points_per_cm2 = 1.0;       ///< wanted on furniture; 0 = no inspection
  double max_incidence_deg = 50;     ///< handles are not visible in more oblique views
  double max_distance_m = 2.5;       ///< of the scanner from faces
  double max_height_m = 2.2;         ///< of furniture
  double min_gain_m2 = 0.5;          ///< area of faces seen too coarsely that is worth a scan
  std::vector<double> heights = {};  ///< of the scanner; empty: as it is carried alone. Not declared

  void declare(OptionTable& table);
};

/// Registered scans.
using ScanRefs = std::vector<std::reference_wrapper<const mapping::Scan>>;

/// A piece of a vertical surface.
struct FacePatch {
  Vector3d centre, normal;  ///< out of the furniture, level
  double density = 0;       ///< points per cm² that the scans so far have put there at good angles
};

/// Vertical surfaces of furniture, in pieces of 15 cm, as registered scans saw them; surfaces that go on up
/// above all furniture are walls. Their density is computed, not counted: by where the scans were taken and
/// what stands between.
std::vector<FacePatch> face_patches(const ScanRefs& scans, const mapping::Voxels& voxels,
                                    const mapping::LaserModel& laser, const InspectionOptions& options);

/// The reachable view, at any of the heights, that brings the largest area of faces to the density that is
/// wanted; no pose when none is worth it. What coverage calls known may have been seen from afar or along its
/// face only, and shows there neither seams nor handles.
NextView inspection_view(const ScanRefs& scans, const mapping::OccupancyMap& map,
                         const mapping::PlanarPose& robot, const mapping::LaserModel& laser,
                         const PlannerOptions& planner, const InspectionOptions& options);

}  // namespace loci::nbv
