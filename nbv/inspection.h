#pragma once

#include <functional>
#include <vector>

#include "mapping/occupancy/occupancy.h"
#include "mapping/sensor/scan.h"
#include "nbv/planner.h"

namespace loci::nbv {

struct InspectionOptions {
  double points_per_cm2 = 1.0;       ///< wanted on furniture; 0 = no inspection
  double max_incidence_deg = 65;     ///< narrow aisles show low fronts no better
  double max_distance_m = 2.5;       ///< of the scanner from faces
  double max_height_m = 2.2;         ///< of furniture
  double min_gain_m2 = 0.5;          ///< area of faces seen too coarsely that is worth a scan
  double min_top_m2 = 0.1;           ///< the same of unseen tops
  std::vector<double> heights = {};  ///< of the scanner; empty: as it is carried alone. Not declared

  void declare(OptionTable& table);
};

/// Registered scans.
using ScanRefs = std::vector<std::reference_wrapper<const mapping::Scan>>;

/// A piece of a surface of furniture.
struct InspectedPatch {
  Vector3d centre, normal;  ///< out of the furniture: level on faces, up on tops
  double density = 0;       ///< points per cm² that the scans so far have put there at good angles
  double area = 0;          ///< m²
  bool top() const { return normal.z() > 0.5; }
};

/// Vertical surfaces of furniture, in pieces of 15 cm, as registered scans saw them; surfaces that go on up
/// above all furniture are walls. Their density is computed, not counted: by where the scans were taken and
/// what stands between.
std::vector<InspectedPatch> face_patches(const ScanRefs& scans, const mapping::Voxels& voxels,
                                         const mapping::LaserModel& laser, const InspectionOptions& options);

/// Tops of furniture that no scan looked down upon, a voxel each: occupied, free above, and wide in both
/// directions. Scans from below show the edge and the underside of a wall shelf, which leaves no frontier.
std::vector<InspectedPatch> unseen_tops(const ScanRefs& scans, const mapping::Voxels& voxels,
                                        const mapping::LaserModel& laser, const InspectionOptions& options);

/// The reachable view, at any of the heights, that brings the largest area of faces to the density that is
/// wanted and shows the most of unseen tops; no pose when none is worth it. What coverage calls known may
/// have been seen from afar or along its face only, and shows there neither seams nor handles.
NextView inspection_view(const ScanRefs& scans, const mapping::OccupancyMap& map,
                         const mapping::PlanarPose& robot, const mapping::LaserModel& laser,
                         const PlannerOptions& planner, const InspectionOptions& options);

}  // namespace loci::nbv
