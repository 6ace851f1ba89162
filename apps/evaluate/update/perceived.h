#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "apps/evaluate/update/experiment.h"

namespace loci::apps::update_claim {

/// What a run of perception said of one piece of furniture that stands elsewhere than its map has it.
struct PerceivedPiece {
  std::string piece;
  double distance = 0, turn_deg = 0;     ///< true motion
  bool noticed = false;                  ///< it was said not to stand where the map has it
  bool found = false;                    ///< where it stands was said
  double position_error = 0;             ///< of its middle, metres
  std::optional<double> turn_error_deg;  ///< unset for round pieces
};

/// What a memory made of the objects on and beside the furniture.
struct RememberedObjects {
  size_t known = 0;           ///< remembered before the furniture was moved, and to be seen after it
  size_t kept = 0;            ///< of these, taken for the same objects after it
  size_t on_moved = 0;        ///< views after it of objects on moved furniture
  size_t on_their_place = 0;  ///< of these, said to lie on it
  size_t phantoms = 0;        ///< objects remembered after it that are none
  size_t false_events = 0;    ///< objects said to have been moved or to be gone, though nobody touched them

  void add(const RememberedObjects& other);
};

/// Furniture was moved, with all that stood on it, and the room is perceived with the map of before.
struct PerceivedTrial {
  std::string world;
  int trial = 0;
  std::vector<PerceivedPiece> moved;
  size_t unmoved = 0;
  std::vector<std::string> called_moved;  ///< of these
  RememberedObjects with, without;        ///< the search for furniture
};

/// Every third trial moves nothing. Pieces move by 0.1 to 2 m and turn by up to 90°.
std::vector<PerceivedTrial> perceive_world(const std::filesystem::path& world, const Settings& settings,
                                           Progress& progress, Warnings& warnings);

std::string perceived_text(const std::vector<PerceivedTrial>& trials, bool verbose);
Json perceived_json(const std::vector<PerceivedTrial>& trials);

}  // namespace loci::apps::update_claim
