#pragma once

#include "mapping/interpretation/plane_raster.h"
#include "mapping/interpretation/supports.h"

namespace loci::mapping {

/// Fills in what the evidence says about a support whose rectangles are roughly known: exact edges (median
/// over scans), what ends it at each side, height (median over scans), areas, inliers, scans, walls.
void measure(Support& support, const PlaneEvidence& evidence, const PlaneRaster& raster,
             const std::vector<VerticalPlane>& walls, const Surface& surface);

/// A slab goes on behind a thing that stands on it from edge to edge: where, beyond a side of a rectangle,
/// the thing and the slab's edge below it are all that is seen until there is surface again, and one front
/// goes through below, the rectangle reaches to that surface's end if it is a strip. Never across what rays
/// passed through.
void extend_behind_things(Support& support, const PlaneEvidence& evidence,
                          const std::vector<VerticalPlane>& faces);

/// Replaces rectangles by a circle or a polygon where that fits what was seen clearly better: round tables,
/// tops with slanted sides.
void fit_outline(Support& support, const PlaneEvidence& evidence, const PlaneRaster& raster);

/// Adds counters whose tops were hardly seen (black gloss gives a depth camera nothing) where a furniture
/// face with a level upper edge stands before a wall, pieces of surface confirm the height, and no ray passed
/// through. Pieces of surface that such a counter explains are taken out.
void add_counters_behind_faces(std::vector<Support>& supports, const Surface& surface,
                               const std::vector<VerticalPlane>& faces,
                               const std::vector<VerticalPlane>& walls, double floor_height);

/// Gives classes to supports and leaves out what stands on others or is a seat, with a note for each.
void classify(SupportSearch& search, const Surface& surface, double floor_height);

}  // namespace loci::mapping
