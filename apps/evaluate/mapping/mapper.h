#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "apps/evaluate/mapping/figures.h"
#include "mapping/base/progress.h"
#include "mapping/simulation/simulated_robot.h"
#include "nbv/survey.h"

namespace loci::apps::mapping_claim {

/// One run: a world is mapped by a simulated robot that has not seen the truth, or from a recording of a walk
/// through it (`walk`), or `world` is a folder with a recording; the map is compared with the truth.
struct Run {
  std::filesystem::path world, truth;
  std::filesystem::path folder;  ///< of the survey: scans, map, report
  std::vector<std::filesystem::path> package_paths;
  std::vector<mapping::PlanarPose> poses;    ///< where to scan from, exactly; empty: the robot explores
  std::optional<mapping::PlanarPose> start;  ///< of the exploration; unset: the most open floor
  bool walk = false;                         ///< a person walks through the world with a simulated Kinect
  bool track = false;                        ///< poses of walks and recordings are tracked
  std::optional<double> floor = 0, ceiling;
  uint64_t seed = 1;
  int threads = 0;
  nbv::SurveyOptions survey;
  mapping::ComparisonOptions comparison;
};

MappedWorld map_world(const Run& run, Progress& progress, Warnings& warnings);

}  // namespace loci::apps::mapping_claim
