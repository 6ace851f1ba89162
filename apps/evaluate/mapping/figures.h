#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "mapping/exchange/comparison/compare.h"

namespace loci::apps::mapping_claim {

/// One map that was made of a world, against the truth.
struct MappedWorld {
  std::string world;
  uint64_t seed = 0;
  mapping::Comparison before;                ///< of what looking alone gives
  std::optional<mapping::Comparison> after;  ///< of what it is after the handles were pulled
  size_t scans = 0, pulls = 0;
  size_t contacts = 0;   ///< pairs of links that penetrate each other in the closed state
  size_t jammed = 0;     ///< joints that something stops before their limit
  double seconds = 0;    ///< the sensor's simulation is in it where the robot explored
  double memory_mb = 0;  ///< peak of the whole process so far

  const mapping::Comparison& last() const { return after ? *after : before; }
};

/// A figure of the claim with its aim, over all seeds of a world.
struct Figure {
  std::string name, unit, aim;
  double value = 0;
  bool known = false;  ///< whether there was anything to measure
  bool met = false;    ///< of figures with an aim
};

/// What a world is called: drawn kitchens are called kitchen.urdf in a folder with their name.
std::string world_name(const std::filesystem::path& world);

/// The figures of the claim in the order of the table; `maps` are those of one world.
std::vector<Figure> figures_of(const std::vector<const MappedWorld*>& maps);

/// One column per world.
std::string table_text(const std::vector<MappedWorld>& maps);
Json table_json(const std::vector<MappedWorld>& maps);

}  // namespace loci::apps::mapping_claim
