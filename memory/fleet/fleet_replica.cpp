#include "memory/fleet/fleet_replica.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstring>

#include "mapping/base/files.h"
#include "mapping/base/text/hash.h"
#include "mapping/base/text/json.h"
#include "mapping/base/text/percent.h"
#include "mapping/base/text/text.h"
#include "memory/store/memory_file.h"

namespace loci::memory {
namespace {

namespace fs = std::filesystem;

/// What a replica is a copy of, beside it.
constexpr const char* kState = "state.json";

Json read_state(const fs::path& folder) {
  std::error_code none;
  if (!fs::exists(folder / kState, none)) return nullptr;
  try {
    return Json::parse(read_file(folder / kState));
  } catch (const std::exception&) {
    return nullptr;  // a replica can always be made anew
  }
}

void make_private_folder(const fs::path& folder) {
  make_folder(folder.parent_path());
  if (::mkdir(folder.c_str(), 0700) != 0 && errno != EEXIST)
    throw Error(std::string("cannot be made: ") + std::strerror(errno), {folder.string(), 0, {}});
}

/// The values of a row of the database. Views last as long as the row.
TableRow row_of(const TableLayout& table, ResultRow result) {
  TableRow row;
  for (size_t i = 0; i < table.columns.size(); ++i) {
    using enum TableColumn::Type;
    if (!result[i])
      row.values.emplace_back();
    else if (table.columns[i].type == integer)
      row.values.emplace_back(integer_of(result[i]));
    else if (table.columns[i].type == real)
      row.values.emplace_back(real_of(result[i]));
    else
      row.values.emplace_back(*result[i]);
  }
  return row;
}

}  // namespace

struct FleetReplica::Source {
  std::string database = {};  ///< id
  RobotName name = {};
  int64_t revision = 0;
  bool complete = false;
  int64_t rows = 0;

  bool of(const Json& state) const {
    return state.is_object() && state.value("database", "") == database &&
           state.value("home", "") == name.home && state.value("robot", "") == name.robot;
  }
};

/// Keeps other processes from updating the same replica.
struct FleetReplica::Lock {
  explicit Lock(const fs::path& folder)
      : descriptor(::open((folder / "lock").c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600)) {
    if (descriptor < 0 || ::flock(descriptor, LOCK_EX) != 0)
      throw Error(std::string("cannot be locked: ") + std::strerror(errno), {folder.string(), 0, {}});
  }
  ~Lock() { ::close(descriptor); }
  Lock(const Lock&) = delete;
  Lock& operator=(const Lock&) = delete;
  void asked() const { ::futimens(descriptor, nullptr); }

  int descriptor;
};

FleetDatabase& FleetConnections::to(const FleetUrl& url) {
  return databases_.try_emplace(url.connection, url).first->second;
}

FleetReplica::FleetReplica(const std::string& url, const fs::path& cache,
                           std::shared_ptr<FleetConnections> connections)
    : FleetReplica(parse_fleet_url(url), cache, std::move(connections)) {}

FleetReplica::FleetReplica(FleetUrl url, const fs::path& cache, std::shared_ptr<FleetConnections> connections)
    : url_(std::move(url)),
      folder_(cache / content_hash(url_.shown + '\n' +
                                   url_.connection.substr(
                                       std::min(url_.connection.find('?'), url_.connection.size())) +
                                   '\n' + url_.home.value_or("") + '\n' + url_.robot.value_or(""))
                          .substr(0, 24)),
      connections_(std::move(connections)) {}

fs::path FleetReplica::fresh_file(const Json& state, double max_age_s) const {
  const fs::path file = file_of(state);
  struct stat lock {};
  if (file.empty() || !url_.names_server || ::stat((folder_ / "lock").c_str(), &lock) != 0) return {};
  const auto asked =
      std::chrono::seconds(lock.st_mtim.tv_sec) + std::chrono::nanoseconds(lock.st_mtim.tv_nsec);
  const std::chrono::duration<double> age = std::chrono::system_clock::now().time_since_epoch() - asked;
  return age.count() < max_age_s ? file : fs::path();
}

fs::path FleetReplica::file_of(const Json& state) const {
  if (!state.is_object()) return {};
  std::error_code none;
  const fs::path file = folder_ / state.value("file", "none");
  return fs::exists(file, none) ? file : fs::path();
}

bool FleetReplica::is_current(FleetDatabase& database, const FleetUrl& url, const Json& state) {
  int found = 0;
  bool same = false;
  try {
    database.sql().query(
        "SELECT v.database::text, r.home, r.robot, r.revision FROM loci.version v, loci.robot r WHERE "
        "($1::text "
        "IS NULL OR r.home = $1) AND ($2::text IS NULL OR r.robot = $2) LIMIT 2",
        {url.home, url.robot}, [&](ResultRow row) {
          ++found;
          same = Source{.database = text_of(row[0]), .name = {text_of(row[1]), text_of(row[2])}}.of(state) &&
                 state.value("revision", int64_t{-1}) == integer_of(row[3]);
        });
  } catch (const Error&) {
    return false;  // update() reports what is wrong
  }
  return found == 1 && same;
}

fs::path FleetReplica::update(Progress& progress, double max_age_s) {
  // Those who ask a fresh replica do not wait for one another.
  if (const fs::path fresh = fresh_file(read_state(folder_), max_age_s); !fresh.empty()) return fresh;
  make_private_folder(folder_);
  const Lock lock(folder_);
  const Json state = read_state(folder_);
  if (const fs::path fresh = fresh_file(state, max_age_s); !fresh.empty()) return fresh;
  const fs::path file = file_of(state);
  try {
    FleetDatabase& database = connections_->to(url_);
    if (!file.empty() && is_current(database, url_, state)) {
      lock.asked();
      return file;
    }
    const fs::path updated = take_news(database, state, file, progress);
    lock.asked();
    return updated;
  } catch (...) {
    connections_->close(url_);  // the next update connects anew
    throw;
  }
}

fs::path FleetReplica::take_news(FleetDatabase& database, const Json& state, const fs::path& file,
                                 Progress& progress) {
  fs::path updated;
  database.transaction(
      [&] {
        const Source source = find_source(database);
        const bool same = !file.empty() && source.of(state);
        if (same && state.value("revision", int64_t{-1}) == source.revision) {
          updated = file;
          return;
        }
        if (!source.complete) {
          if (!same)
            throw database.error(
                fmt::format("the first push of robot '{}' has not been completed", source.name.robot),
                "push it again");
          updated = file;  // as before the push that is under way
          return;
        }
        updated = same ? file : next_file();
        if (!pull(database, source, updated, progress)) {
          updated = next_file();
          if (!pull(database, source, updated, progress))
            throw database.error(
                fmt::format("the rows of robot '{}' are not those that it pushed", source.name.robot),
                "loci-memory push --replace puts them right; loci-memory verify checks the robot's file");
        }
        write_file_atomically(folder_ / kState, Json{{"database", source.database},
                                                     {"home", source.name.home},
                                                     {"robot", source.name.robot},
                                                     {"revision", source.revision},
                                                     {"file", updated.filename().string()}}
                                                    .dump());
        remove_others(updated);
      },
      "BEGIN ISOLATION LEVEL REPEATABLE READ, READ ONLY");
  return updated;
}

FleetReplica::Source FleetReplica::find_source(FleetDatabase& database) {
  Source source{.database = database.check_schema()};
  std::vector<std::string> found;
  database.sql().query(
      "SELECT r.home, r.robot, r.revision, r.complete, (SELECT coalesce(sum(c.rows), 0)::bigint FROM "
      "loci.cursor c "
      "WHERE c.home = r.home AND c.robot = r.robot) FROM loci.robot r WHERE ($1::text IS NULL OR r.home = "
      "$1) AND "
      "($2::text IS NULL OR r.robot = $2) ORDER BY r.home, r.robot LIMIT 20",
      {url_.home, url_.robot}, [&](ResultRow row) {
        source.name = {text_of(row[0]), text_of(row[1])};
        source.revision = integer_of(row[2]);
        source.complete = integer_of(row[3]) != 0;
        source.rows = integer_of(row[4]);
        found.push_back(fmt::format("'{}' of home '{}'", source.name.robot, source.name.home));
      });
  if (found.empty())
    throw database.error(url_.robot
                             ? fmt::format("has no memory of robot '{}' that this role may read", *url_.robot)
                             : "has no memory that this role may read");
  if (found.size() > 1)
    throw database.error(fmt::format("has the memories of {} robots: {}", found.size(), joined(found, ", ")),
                         "end the URL with ?robot=NAME, and &home=NAME where homes share names");
  return source;
}

bool FleetReplica::pull(FleetDatabase& database, const Source& source, const fs::path& file,
                        Progress& progress) {
  TableWriter writer(file);
  int64_t rows = 0;
  for (const TableLayout& table : table_layouts()) {
    if (!table.appended) writer.clear(table);
    SqlParameters parameters = {source.name.home, source.name.robot};
    const std::string condition =
        table.appended ? after_key(table, writer.last_key(table), parameters) : std::string();
    database.sql().query(fmt::format("SELECT {} FROM {} WHERE home = $1 AND robot = $2{} ORDER BY {}",
                                     column_list(table), table_name(table), condition, key_list(table)),
                         parameters, [&](ResultRow row) {
                           writer.add(table, row_of(table, row));
                           if (++rows % 1000 == 0)
                             progress.check(std::min(0.99, double(rows) / double(source.rows + 1)),
                                            "reading " + table.name);
                         });
  }
  write_file_atomically(file.string() + kReplicaOf,
                        fmt::format("{}?home={}&robot={}\n", url_.shown, percent_encoded(source.name.home),
                                    percent_encoded(source.name.robot)));
  return writer.commit();
}

fs::path FleetReplica::next_file() const {
  int64_t number = 0;
  std::error_code none;
  for (const auto& entry : fs::directory_iterator(folder_, none)) {
    const std::string name = entry.path().filename();
    if (name.starts_with("memory.")) number = std::max<int64_t>(number, std::atoll(name.c_str() + 7));
  }
  return folder_ / fmt::format("memory.{}.loci", number + 1);
}

void FleetReplica::remove_others(const fs::path& file) const {
  const std::string kept = file.filename();
  std::error_code none;
  std::vector<fs::path> others;
  for (const auto& entry : fs::directory_iterator(folder_, none)) {
    const std::string name = entry.path().filename();
    if (name.starts_with("memory.") && !name.starts_with(kept)) others.push_back(entry.path());
  }
  for (const fs::path& other : others) fs::remove(other, none);
}

}  // namespace loci::memory
