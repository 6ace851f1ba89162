#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "mapping/base/options.h"
#include "mapping/base/progress.h"
#include "mapping/base/text/json_fwd.h"
#include "mapping/simulation/scenario.h"
#include "mapping/world/mesh.h"

namespace loci::mapping {

struct RecordOptions {
  int seed = 1;
  std::string noise = "kinect";
  bool force = false;  ///< may replace a recording that loci did not write
  int threads = 0;
  std::vector<std::filesystem::path> package_paths = {};  ///< where package:// of the world is looked for

  void declare(OptionTable& table);
};

struct RecordResult {
  size_t scenes = 0;
  size_t frames = 0;
  size_t objects = 0;  ///< different ones seen in at least one frame
  std::string folder;

  std::string summary() const;
  Json report() const;
};

/// The floor that a world without one gets, 40 m wide around the origin of the map.
TriangleMesh floor_mesh(double height);

/// Plays a scenario, renders every frame as the sensor would measure it, and writes a recording with
/// joints.csv, truth.jsonl and simulation.json (the options that made it). Same seed, same bytes on any
/// number of threads. truth.jsonl has a line per frame; its objects have:
///   id, model, support (link or object), pose (map_from_object, x y z qx qy qz qw; origin in the middle of
///   the bottom), size (extents in its own frame), pixels (of the depth image), visible (part of what would
///   be seen of it in this image if nothing stood before it; null when it is outside), box (first column,
///   first row, last column, last row in the depth image; null when not seen).
RecordResult record(const Scenario& scenario, const std::filesystem::path& folder,
                    const RecordOptions& options, Progress& progress, Warnings& warnings);

}  // namespace loci::mapping
