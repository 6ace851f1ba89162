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
  double min_top_m2 = 0.05;          ///< likewise of tops: the smallest support that is interpreted
  std::vector<double> heights = {};  ///< of the scanner; empty: as it is carried alone. Not declared

  void declare(OptionTable& table);
};

/// Registered scans.
using ScanRefs = std::vector<std::reference_wrapper<const mapping::Scan>>;

/// A piece of a surface of furniture.
struct FacePatch {
  Vector3d centre, normal;  ///< out of the furniture: level, or up
  double wanted = 0;        ///< points per cm² that show what is on it
  double area = 0;          ///< m²
  double density = 0;       ///< points per cm² that the scans so far have put there at good angles

  bool is_top() const { return normal.z() > 0.5; }
};

/// Vertical surfaces of furniture, in pieces of 15 cm, as registered scans saw them; surfaces that go on up
/// above all furniture are walls. Their density is computed, not counted: by where the scans were taken and
/// what stands between.
std::vector<FacePatch> face_patches(const ScanRefs& scans, const mapping::Voxels& voxels,
                                    const mapping::LaserModel& laser, const InspectionOptions& options);

/// Upward surfaces that the scanner at none of its heights sees but in passing: up to 5 cm below the highest,
/// and not so low that every view from the carried height shows them. Occupied space under free space, in
/// pieces of 15 cm; density as for faces.
std::vector<FacePatch> top_patches(const ScanRefs& scans, const mapping::Voxels& voxels,
                                   const mapping::LaserModel& laser, const InspectionOptions& options);

/// The reachable view, at any of the heights, that brings the largest area of faces to the density that is
/// wanted, and where none is worth it, of tops; no pose when neither is. What coverage calls known may have
/// been seen from afar or along its face only, and shows there neither seams nor handles.
NextView inspection_view(const ScanRefs& scans, const mapping::OccupancyMap& map,
                         const mapping::PlanarPose& robot, const mapping::LaserModel& laser,
                         const PlannerOptions& planner, const InspectionOptions& options);

}  // namespace loci::nbv
