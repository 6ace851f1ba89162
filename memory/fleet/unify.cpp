#include "memory/fleet/unify.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "mapping/base/temporary_folder.h"
#include "mapping/base/text/json.h"
#include "mapping/base/text/text.h"
#include "memory/edits/edits.h"
#include "memory/fleet/fleet_replica.h"
#include "memory/fleet/push.h"
#include "memory/reasoning/reason.h"
#include "memory/store/rows/merge.h"

namespace loci::memory {
namespace {

namespace fs = std::filesystem;

constexpr const char* kProgram = "loci-memory unify";

/// $1 = home, $2 = the unified memory. Observations are the same by recording, frame and number.
constexpr const char* kIdentities = R"(
WITH seen AS (
  SELECT a.robot, a.object, r.fingerprint, s.frame_index, o.number FROM loci.association_now a
    JOIN loci.observation o ON o.home = a.home AND o.robot = a.robot AND o.id = a.observation
    JOIN loci.scene s ON s.home = a.home AND s.robot = a.robot AND s.id = o.scene
    JOIN loci.recording r ON r.home = a.home AND r.robot = a.robot AND r.id = s.recording
  WHERE a.home = $1 AND a.chosen = 1 AND a.object IS NOT NULL AND a.probability > 0)
INSERT INTO loci.identity
  SELECT $1, $2, u.object, m.robot, m.object, count(*), now()
  FROM seen u JOIN seen m USING (fingerprint, frame_index, number)
  WHERE u.robot = $2 AND m.robot <> $2 GROUP BY u.object, m.robot, m.object)";

/// The other robots of the home. Error when `unified` is one of them.
std::vector<std::string> robots_beside(FleetDatabase& database, const RobotName& unified) {
  std::vector<std::string> robots;
  database.sql().query("SELECT robot, program, complete FROM loci.robot WHERE home = $1 ORDER BY robot",
                       {unified.home}, [&](ResultRow row) {
                         const std::string robot = text_of(row[0]);
                         if (robot != unified.robot) {
                           if (integer_of(row[2]) != 0) robots.push_back(robot);
                         } else if (!text_of(row[1]).starts_with(kProgram)) {
                           throw database.error(fmt::format("'{}' is a robot of this home", robot),
                                                "give another name with --as");
                         }
                       });
  if (robots.empty())
    throw database.error(fmt::format("has no memory of home '{}' that this role may read", unified.home));
  return robots;
}

}  // namespace

std::string UnifyResult::summary() const {
  return fmt::format("{} of {} are {}.", counted(static_cast<size_t>(their_objects), "object"),
                     counted(robots.size(), "robot"), counted(static_cast<size_t>(objects), "object"));
}

Json UnifyResult::report() const {
  return {{"robots", robots}, {"objects_of_robots", their_objects}, {"objects", objects}};
}

UnifyResult unify(const FleetUrl& url, const RobotName& unified, const fs::path& cache, Progress& progress) {
  check_name(unified);
  FleetDatabase database(url);
  database.check_schema();
  UnifyResult result{.robots = robots_beside(database, unified)};
  const TemporaryFolder folder("unify", cache);
  fs::path merged;
  for (size_t i = 0; i < result.robots.size(); ++i) {
    FleetUrl robot = url;
    robot.home = unified.home;
    robot.robot = result.robots[i];
    const double begin = double(i) / double(result.robots.size());
    PartialProgress part(progress, 0.5 * begin, 0.5 * begin + 0.5 / double(result.robots.size()));
    const fs::path replica = FleetReplica(robot, cache).update(part);
    const fs::path joined = folder.path() / fmt::format("merged_{}.loci", i);
    try {
      if (i > 0) merge(merged, replica, joined, {}, part);
    } catch (const FramesDiffer&) {
      const std::vector<std::string> before(result.robots.begin(), result.robots.begin() + ptrdiff_t(i));
      throw database.error(
          fmt::format("robot '{}' of home '{}' has neither a map nor a recording in common with '{}'",
                      robot.robot.value(), unified.home, fmt::join(before, "', '")),
          "robots of one home use one map; others belong to another --home");
    }
    merged = i > 0 ? joined : replica;
  }
  const fs::path reasoned = folder.path() / "unified.loci";
  {
    const Store store = Store::open_read(merged);
    PartialProgress part(progress, 0.5, 0.9);
    reason(store, reasoned, {}, {}, part, known_identities(store));
  }
  PartialProgress part(progress, 0.9, 1);
  MemoryPush(reasoned, url, {.name = unified, .replace = true, .program = kProgram}).run(part);
  const SqlParameters name = {unified.home, unified.robot};
  database.transaction([&] {
    database.sql().run("DELETE FROM loci.identity WHERE home = $1 AND robot = $2", name);
    database.sql().run(kIdentities, name);
  });
  database.sql().query(
      "SELECT count(DISTINCT (of_robot, of_object)), count(DISTINCT object) FROM loci.identity WHERE home = "
      "$1 AND "
      "robot = $2",
      name, [&](ResultRow row) {
        result.their_objects = integer_of(row[0]);
        result.objects = integer_of(row[1]);
      });
  return result;
}

}  // namespace loci::memory
