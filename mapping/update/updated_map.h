#pragma once

#include <vector>

#include "mapping/registration/surfels.h"
#include "mapping/update/update.h"

namespace loci::mapping {

/// Scans of one epoch, and which of their surfels show the room otherwise than it is at rest now.
struct EpochScans {
  const ScanSet& scans;  ///< poses in the map frame
  const registration::Surfels& surface;
  const std::vector<uint8_t>& dropped;  ///< by surfel
};

/// The scans that show the room as it is now, with all joints at 0: points on dropped surfels are left out,
/// and earlier rays through places where furniture stands now. New scans are named after the number of the
/// update, "update1_scan_000".
ScanSet current_scans(const EpochScans& before, const EpochScans& now, const std::vector<MapChange>& changes);

/// The map after the changes of `result`: links of moved furniture at their new poses, those of furniture
/// that is gone removed, and what an interpretation of `result.scans` adds: links where the new surface is
/// unexplained by the map, and better estimates of links that stayed. Links keep their names, aliases and
/// joints.
InterpretedMap updated_map(const World& world, const SemanticMap& semantics, const registration::Surfels& now,
                           const std::vector<uint8_t>& unexplained, const UpdateResult& result, int threads,
                           Progress& progress);

}  // namespace loci::mapping
