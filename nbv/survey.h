#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "mapping/base/json.h"
#include "mapping/base/options.h"
#include "mapping/base/progress.h"
#include "mapping/interpretation/interpretation.h"
#include "mapping/registration/registration.h"
#include "mapping/simulation/scanned_world.h"
#include "nbv/planner.h"

namespace loci {

struct SurveyOptions {
  int scans_max = 40;
  bool interact = false;
  double pull_way_m = 0.25;
  PlannerOptions planner;
  OccupancyOptions occupancy;
  RegistrationOptions registration;
  InterpretationOptions interpretation;

  void declare(OptionTable& table);
};

struct SurveyResult {
  InterpretedMap map;
  ScanSet scans;
  Json exploration;  ///< explore.json: per step pose, reason, overlap, coverage, times; the stopping reason
  std::string summary() const;
};

/// Explores a room until nothing is gained, interprets it, and with `interact` pulls each handle and scans
/// again. Writes a checkpoint into `folder` after each scan; with `resume` it goes on from there.
SurveyResult survey(ScannedWorld& robot, const PlanarPose& start, const std::filesystem::path& folder,
                    bool resume, const SurveyOptions& options, Progress& progress, Warnings& warnings);

}  // namespace loci
