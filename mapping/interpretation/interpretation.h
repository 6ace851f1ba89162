#pragma once

#include "mapping/base/options.h"
#include "mapping/base/progress.h"
#include "mapping/sensor/scan.h"
#include "mapping/world/semantic_map.h"
#include "mapping/world/world.h"

namespace loci {

struct InterpretationOptions {
  double support_min_area_m2 = 0.05;
  double wall_min_area_m2 = 0.5;
  double plane_tolerance_m = 0.02;
  int threads = 0;

  void declare(OptionTable& table);
};

/// A map out of scans: what was recognised, with evidence, and what was not.
struct InterpretedMap {
  World world;                     ///< floor, walls, supports as links with visual, collision and inertia
  SemanticMap semantics;           ///< class, geometry, confidence, evidence of each link
  std::vector<std::string> notes;  ///< e.g. "no free-space evidence: the input is a bare cloud"
  std::string summary() const;
};

/// Floor, walls and horizontal supports (counter, table, shelf) with outlines from a scan set (§7.4). Never
/// invents: every link says which points and scans it rests on.
InterpretedMap interpret(const ScanSet& scans, const InterpretationOptions& options, Progress& progress);

}  // namespace loci
