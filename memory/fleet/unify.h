#pragma once

#include "mapping/base/progress.h"
#include "mapping/base/text/json_fwd.h"
#include "memory/fleet/fleet_database.h"

namespace loci::memory {

struct UnifyResult {
  std::vector<std::string> robots = {};
  int64_t their_objects = 0;  ///< of the robots, with an observation that the unified memory has
  int64_t objects = 0;        ///< that these are

  std::string summary() const;
  Json report() const;
};

/// Joins the memories of the robots of a home into one, reasons over all of their observations, and pushes
/// the result as the memory of a robot of its own, `unified`: its rows name their run, its recordings where
/// they come from, and loci.identity which objects of the robots its objects are. Nothing of the robots
/// changes. Again, it brings that memory to their present state. The memories must be in one map frame, as
/// for merge(). Needs the rights to read the home and to push `unified`. `cache` as for FleetReplica.
UnifyResult unify(const FleetUrl& url, const RobotName& unified, const std::filesystem::path& cache,
                  Progress& progress);

}  // namespace loci::memory
