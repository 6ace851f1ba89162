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

/// A recording with poses in the frame of a map of the same room, by the scans of the map. A tracked one is
/// placed; Error with the reason when it does not fit the map, or fits in several places. One with poses of
/// its own stays where half of what it shows lies on the map's scans. Else it is levelled by what it shows
/// and placed; where no place is found, it stays. Warns where it was placed, or that the poses do not fit.
std::unique_ptr<Recording> placed_in_map(std::unique_ptr<Recording> recording, bool is_tracked,
                                         const SemanticMap& map, const ScanSet& map_scans, int threads,
                                         Progress& progress, Warnings& warnings);

/// A recording as it is perceived with a map (URDF): in its frame, tracked where it has no poses, and placed
/// by the scans in `scans/` beside the map. Without such scans own poses are believed, and tracked ones of a
/// camera that moved stay in their frame, with a warning. Error with the reason where a recording without
/// poses cannot be placed; `is_fixed`: its camera is known to have stood still.
std::unique_ptr<Recording> perceived_in_map(std::unique_ptr<Recording> recording,
                                            const std::filesystem::path& map, bool is_fixed, int threads,
                                            Progress& progress, Warnings& warnings);

}  // namespace loci::mapping
