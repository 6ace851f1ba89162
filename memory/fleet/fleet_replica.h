#pragma once

#include "mapping/base/progress.h"
#include "memory/fleet/fleet_database.h"
#include "memory/store/store.h"

namespace loci::memory {

/// A replica that is younger than this is not checked again.
inline constexpr double kFreshReplica_s = 1;

/// A memory of a database as a file of this machine, which questions, the browser and other programs open
/// like any other. It is brought up to date by the rows that are new; when rows that it has were changed or
/// removed in the database, it is made anew, so that nothing of them stays. One process at a time updates it,
/// others wait. Only its user can read it (mode 0600 in a folder of 0700).
class FleetReplica {
 public:
  /// `cache` is the folder for all replicas. Nothing is done yet.
  FleetReplica(FleetUrl url, const std::filesystem::path& cache);
  FleetReplica(const std::string& url, const std::filesystem::path& cache);

  /// The file in the state of the last completed push. It is asked for in the database unless that was done
  /// within the last `max_age_s` and the URL names server and database. Error when the server cannot be
  /// reached, the role may not read the memory, or the URL names none or several.
  std::filesystem::path update(Progress& progress, double max_age_s = 0);

 private:
  struct Source;
  struct Lock;

  Source find_source(FleetDatabase& database);
  /// The file with the rows of the source; unset when rows that it had are not those of the source any more.
  bool pull(FleetDatabase& database, const Source& source, const std::filesystem::path& file,
            Progress& progress);
  std::filesystem::path next_file() const;
  void remove_others(const std::filesystem::path& file) const;

  FleetUrl url_;
  std::filesystem::path folder_;
  std::unique_ptr<FleetDatabase> database_;  ///< stays open between updates
};

}  // namespace loci::memory
