#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "mapping/base/text/json.h"
#include "mapping/world/world.h"

namespace loci::mapping {

/// What is known about one link of a map beyond its shape (the sidecar map.semantic.json,
/// docs/file-formats.md).
struct SemanticLink {
  std::string class_name;  ///< floor, ceiling, wall, counter, island, table, shelf, cabinet, front, drawer, …
  double confidence = 0;             ///< uncalibrated, in [0,1]
  Json geometry;                     ///< in the map frame, all joints at 0; fields depend on the class
  Json evidence;                     ///< e.g. {"inliers": 412, "scans": [0, 3]}
  std::vector<std::string> aliases;  ///< names that people gave
  std::string appliance;             ///< e.g. "fridge"; empty = none
  Json extra = Json::object();       ///< fields that this version does not know; kept
};

/// The sidecar of a map.
struct SemanticMap {
  std::string frame = "map";
  std::map<std::string, SemanticLink> links;  ///< by link name
  std::optional<Isometry3d> map_from_input;   ///< set when the input had to be levelled; x y z qx qy qz qw
  Json extra = Json::object();                ///< fields that this version does not know; kept
};

/// Error with file and key for what is missing or of the wrong type, and for another version.
SemanticMap read_semantic_map(const std::filesystem::path& path);
void write_semantic_map(const SemanticMap& map, const std::filesystem::path& path);

Json to_json(const SemanticMap& map);
SemanticMap semantic_map_from_json(const Json& json, const std::string& file);

/// The sidecar's path for a map: "kitchen.urdf" → "kitchen.semantic.json".
std::filesystem::path sidecar_path(const std::filesystem::path& urdf);

}  // namespace loci::mapping
