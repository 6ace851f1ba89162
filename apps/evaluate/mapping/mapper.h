#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "apps/evaluate/mapping/figures.h"
#include "mapping/base/progress.h"
#include "mapping/interpretation/interpretation.h"
#include "mapping/simulation/scanned_world.h"

namespace loci::mapping_claim {

/// One run: a world is mapped by a simulated robot that has not seen the truth, and compared with it.
struct Run {
  std::filesystem::path world, truth;
  std::vector<std::filesystem::path> package_paths;
  std::vector<PlanarPose> poses;  ///< where to scan from
  std::optional<double> ceiling;
  uint64_t seed = 1;
  int threads = 0;
  ComparisonOptions comparison;
  InterpretationOptions interpretation;
};

MappedWorld map_world(const Run& run, Progress& progress, Warnings& warnings);

/// The map as it would be had nobody touched anything: every joint as the front's geometry suggests.
MapStructure with_prior_joints(MapStructure map);

}  // namespace loci::mapping_claim
