#pragma once

#include <map>
#include <memory>

#include "mapping/base/progress.h"
#include "mapping/base/text/json_fwd.h"
#include "memory/fleet/fleet_database.h"
#include "memory/store/store.h"

namespace loci::memory {

/// A replica that is younger than this is not checked again.
inline constexpr double kFreshReplica_s = 1;

/// Connections that the replicas of one thread share: a program that asks twenty robots has one of each
/// database.
class FleetConnections {
 public:
  /// Made when it is first needed, and after it was closed.
  FleetDatabase& to(const FleetUrl& url);
  void close(const FleetUrl& url) { databases_.erase(url.connection); }

 private:
  std::map<std::string, FleetDatabase> databases_;
};

/// A memory of a database as a file of this machine, which questions, the browser and other programs open
/// like any other. It is brought up to date by the rows that are new; when rows that it has were changed or
/// removed in the database, it is made anew, so that nothing of them stays. One process at a time updates it,
/// others wait. Only its user can read it (mode 0600 in a folder of 0700).
class FleetReplica {
 public:
  /// `cache` is the folder for all replicas. Nothing is done yet.
  FleetReplica(FleetUrl url, const std::filesystem::path& cache,
               std::shared_ptr<FleetConnections> connections = std::make_shared<FleetConnections>());
  FleetReplica(const std::string& url, const std::filesystem::path& cache,
               std::shared_ptr<FleetConnections> connections = std::make_shared<FleetConnections>());

  /// The file in the state of the last completed push. It is asked for in the database unless that was done
  /// within the last `max_age_s` and the URL names server and database. Error when the server cannot be
  /// reached, the role may not read the memory, or the URL names none or several.
  std::filesystem::path update(Progress& progress, double max_age_s = 0);

 private:
  struct Source;
  struct Lock;

  /// The file that a state names, when it is there; fresh_file(): and when the database was asked within the
  /// last `max_age_s`, by any process.
  std::filesystem::path file_of(const Json& state) const;
  std::filesystem::path fresh_file(const Json& state, double max_age_s) const;
  /// Whether the database has what the state says: one query.
  static bool is_current(FleetDatabase& database, const FleetUrl& url, const Json& state);
  /// The file in the state of the last completed push; `file`: that of `state`, or empty.
  std::filesystem::path take_news(FleetDatabase& database, const Json& state,
                                  const std::filesystem::path& file, Progress& progress);
  Source find_source(FleetDatabase& database);
  /// The file with the rows of the source; unset when rows that it had are not those of the source any more.
  bool pull(FleetDatabase& database, const Source& source, const std::filesystem::path& file,
            Progress& progress);
  std::filesystem::path next_file() const;
  void remove_others(const std::filesystem::path& file) const;

  FleetUrl url_;
  std::filesystem::path folder_;
  std::shared_ptr<FleetConnections> connections_;  ///< stay open between updates
};

}  // namespace loci::memory
