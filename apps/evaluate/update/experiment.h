#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "mapping/base/error.h"
#include "mapping/base/progress.h"
#include "mapping/base/text/json_fwd.h"

namespace loci::apps::update_claim {

struct Settings {
  std::vector<std::filesystem::path> package_paths;
  std::vector<std::string> families = {"table", "chair", "stool", "crate", "island", "trolley"};
  std::filesystem::path folder;  ///< for maps and recordings; maps that are there are used again
  int trials = 4;                ///< per world
  int moves = 5;                 ///< at most, per trial
  bool kinect = false;           ///< a simulated Kinect is walked through instead of the laser
  bool part = false;             ///< two views (laser) or places (Kinect) only
  int seed = 1;
  int threads = 0;
  bool keep = false;  ///< recordings and memories of perceived rooms
};

/// What the update said of one piece that was moved.
struct MovedPiece {
  std::string world, piece;
  int trial = 0;
  double distance = 0;  ///< true, metres
  size_t points = 0;    ///< on the piece at its new place
  bool found = false;
  bool swapped = false;                  ///< found as another piece of the same shape
  double position_error = 0;             ///< of its centre, metres
  std::optional<double> turn_error_deg;  ///< unset for round pieces
  std::string said;                      ///< of it, where it was not found
};

struct Trial {
  std::string world;
  int trial = 0;
  std::vector<MovedPiece> moved;
  size_t unmoved = 0, called_moved = 0;  ///< pieces that stayed, and those said to have moved or to be gone
  size_t invented = 0;                   ///< pieces that came although nothing did
  std::vector<std::string> wrong;        ///< texts of false changes
  double seconds = 0;
};

/// Maps a world by exploration, moves furniture of it `trials` times and updates the map from new scans.
std::vector<Trial> run_world(const std::filesystem::path& world, const Settings& settings, Progress& progress,
                             Warnings& warnings);

std::string table_text(const std::vector<Trial>& trials, bool verbose);
Json table_json(const std::vector<Trial>& trials);

}  // namespace loci::apps::update_claim
