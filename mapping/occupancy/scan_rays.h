#pragma once

#include <octomap/OcTree.h>

#include <cstdint>
#include <vector>

#include "mapping/occupancy/key_box.h"
#include "mapping/sensor/scan.h"

namespace loci::mapping::occupancy {

/// A ray as OctoMap's insertPointCloud casts it: map frame, cut at the range.
struct Ray {
  octomap::point3d end;
  uint16_t origin = 0;  ///< index into ScanRays::origins
  bool cast = false;    ///< its ends lie inside the tree's range of keys
  bool hit = false;     ///< `end` was measured and is occupied
};

struct ScanRays {
  std::vector<octomap::point3d> origins;
  std::vector<Ray> rays;
  KeyBox box;  ///< all cells that the rays can touch; empty when there is none
};

/// The rays of a scan. Positions go to the map frame in double and are rounded to float there; points that
/// are not finite or outside the tree are left out. A point without return, or beyond `range_max`, ends
/// nowhere: its ray is free up to where it stands, at most `range_max`.
ScanRays scan_rays(const Scan& scan, const octomap::OcTree& tree, double range_max, int threads);

/// Marks every cell that rays [begin, end) pass through with kPassed, bit for bit the cells of OctoMap's
/// computeRayKeys (Amanatides and Woo 1987), four rays at a time. `cells` covers rays.box.
void mark_passed(const ScanRays& rays, size_t begin, size_t end, const octomap::OcTree& tree, uint8_t* cells);

/// Marks the cells where rays [begin, end) were returned with kHit.
void mark_hits(const ScanRays& rays, size_t begin, size_t end, const octomap::OcTree& tree, uint8_t* cells);

}  // namespace loci::mapping::occupancy
