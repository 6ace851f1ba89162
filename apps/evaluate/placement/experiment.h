#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "mapping/base/progress.h"
#include "mapping/base/text/json_fwd.h"
#include "mapping/update/placement.h"

namespace loci::apps::placement_claim {

struct Settings {
  std::vector<std::filesystem::path> package_paths;
  std::filesystem::path folder;  ///< of the recordings; those that are there are used again
  int seed = 1;
  int visits = 1;          ///< per world
  int places = 3;          ///< where the person turns round
  bool tracked = true;     ///< videos; else single depth images whose poses are known but for the frame
  bool stretched = false;  ///< also other rooms that differ from a visit's own only in size
  int threads = 0;
};

enum class Outcome { right, wrong, refused };

/// One visit and one map.
struct Trial {
  std::string map, visit;  ///< names of the worlds
  double stretch = 0;      ///< of the visit's room, part of its length and width
  size_t frames = 0, lost = 0;
  mapping::Placement placement;
  double error_m = 0, error_deg = 0;  ///< mean over the frames, in the map of its own room
  Outcome outcome = Outcome::refused;

  bool own_room() const { return map == visit && stretch == 0; }
};

/// Somebody walks through each world with a simulated Kinect and poses, which makes its map, and again,
/// through a part of it, without: each of these visits is placed in all maps, as `loci-perceive run --map`
/// does. In the map of its own room it is right within 5 cm and 2 degrees; in others any placement is wrong.
std::vector<Trial> place_visits(const std::vector<std::filesystem::path>& worlds, const Settings& settings,
                                Progress& progress, Warnings& warnings);

std::string table_text(const std::vector<Trial>& trials, bool verbose);
Json table_json(const std::vector<Trial>& trials);

}  // namespace loci::apps::placement_claim
