#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "mapping/interpretation/interpretation.h"
#include "nbv/exploration.h"
#include "nbv/interaction.h"

namespace loci::nbv {

struct SurveyOptions {
  bool interact = false;
  /// From the frame of what is explored, where the floor is not at z = 0, to the robot's map: for the
  /// sidecar; not declared.
  std::optional<Isometry3d> map_from_input;
  ExplorationOptions exploration;
  mapping::InterpretationOptions interpretation;
  InteractionOptions interaction;

  void declare(OptionTable& table);
};

struct SurveyResult {
  mapping::InterpretedMap map;
  mapping::ScanSet scans;
  std::vector<ExplorationStep> steps;
  std::vector<mapping::Front>
      fronts_before;  ///< as they looked before handles were pulled; empty without `interact`
  std::vector<Interaction> interactions;
  std::string stop_reason;
  double seconds = 0;

  /// Whether most of the scans could be registered. Otherwise the map shows but a part of the room.
  bool usable() const;
  std::string summary() const;
  Json report() const;
};

/// Explores a room until nothing is gained, interprets it, and with `interact` pulls each handle and scans
/// again (§7.3 to §7.5). Writes `scans/`, `explore.json`, `map.urdf`, `map.semantic.json` and `report.html`
/// into the folder, and the images of every plan into `plans/`; every scan is a checkpoint from which
/// `resume` goes on.
SurveyResult survey(mapping::Robot& robot, const mapping::PlanarPose& start,
                    const std::filesystem::path& folder, bool resume, const SurveyOptions& options,
                    Progress& progress, Warnings& warnings);

}  // namespace loci::nbv
