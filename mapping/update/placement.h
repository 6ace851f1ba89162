#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "mapping/base/error.h"
#include "mapping/base/progress.h"
#include "mapping/recording/recording.h"
#include "mapping/sensor/scan.h"
#include "mapping/world/semantic_map.h"

namespace loci::mapping {

/// Where scans lie in the frame of other scans of the same room.
struct Placement {
  Isometry3d map_from_scans = Isometry3d::Identity();
  double overlap = 0;   ///< of the smaller surface with the other
  double conflict = 0;  ///< part of the points in space that the others saw as free
  double rmse_m = 0;
  bool trusted = false;
  std::string reason;  ///< why trusted or not
};

/// The scans that a map was made from, in its frame: those that were not level are moved by its
/// map_from_input.
ScanSet read_scans_of_map(const std::filesystem::path& folder, const SemanticMap& map, Warnings& warnings);

/// Places scans whose frame has z up, such as those of a tracked recording, in a map's frame, of which
/// nothing else is known: heights of horizontal surfaces give candidates for z, a search over the whole room
/// x, y and yaw, and registration the rest and the verdict. Not trusted where another place fits about as
/// well.
Placement place_scans(const ScanSet& map_scans, const ScanSet& scans, int threads, Progress& progress);

/// What a recording with poses shows, as place_scans takes it: enough of its frames to know a room again.
ScanSet scans_to_place(const Recording& recording, int threads, Progress& progress);

/// Error with the reason when scans of `path` are not placed.
void require_trusted(const Placement& placement, const std::string& path);

/// A tracked recording in the frame of a map (URDF) of the same room, by the scans of the map in `scans/`
/// beside it. Warns where it was placed, or that it was not, because the map has no scans: then it stays in
/// its frame. Error with the reason when it does not fit the map, or fits in several places.
std::unique_ptr<Recording> placed_in_map(std::unique_ptr<Recording> tracked, const std::filesystem::path& map,
                                         int threads, Progress& progress, Warnings& warnings);

}  // namespace loci::mapping
