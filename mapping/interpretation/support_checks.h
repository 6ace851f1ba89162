#pragma once

#include "mapping/interpretation/plane_raster.h"
#include "mapping/interpretation/supports.h"

namespace loci {

/// Fills in what the evidence says about a support whose rectangles are roughly known: exact edges (median
/// over scans), what ends it at each side, height (median over scans), areas, inliers, scans, walls.
void measure(Support& support, const PlaneEvidence& evidence, const PlaneRaster& raster,
             const std::vector<VerticalPlane>& walls, const Surface& surface);

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

}  // namespace loci
