#include "memory/fleet/unify.h"

namespace loci::memory {
namespace {

/// Observations of objects by what is the same in every memory. $1 = home.
constexpr const char* kIdentities =
    "WITH seen AS (SELECT a.robot, a.object, r.fingerprint, s.frame_index, o.number FROM "
    "loci.association_now a "
    "JOIN loci.observation o ON o.home = a.home AND o.robot = a.robot AND o.id = a.observation "
    "JOIN loci.scene s ON s.home = a.home AND s.robot = a.robot AND s.id = o.scene "
    "JOIN loci.recording r ON r.home = a.home AND r.robot = a.robot AND r.id = s.recording "
    "WHERE a.home = $1 AND a.chosen = 1 AND a.object IS NOT NULL AND a.probability > 0) "
    "INSERT INTO loci.identity SELECT $1, $2, u.object, m.robot, m.object, count(*), now() FROM seen u JOIN "
    "seen m "
    "USING (fingerprint, frame_index, number) WHERE u.robot = $2 AND m.robot <> $2 GROUP BY u.object, "
    "m.robot, "
    "m.object";

}  // namespace

std::vector<std::string> robots_of_home(const FleetUrl& url, const std::string& home,
                                        const std::string& except) {
  FleetDatabase database(url);
  database.check_schema();
  std::vector<std::string> robots;
  database.sql().query(
      "SELECT robot FROM loci.robot WHERE home = $1 AND robot <> $2 AND complete ORDER BY robot",
      {home, except}, [&](ResultRow row) { robots.push_back(text_of(row[0])); });
  return robots;
}

int64_t write_identities(const FleetUrl& url, const RobotName& unified) {
  FleetDatabase database(url);
  database.check_schema();
  database.transaction([&] {
    database.sql().run("DELETE FROM loci.identity WHERE home = $1 AND robot = $2",
                       {unified.home, unified.robot});
    database.sql().run(kIdentities, {unified.home, unified.robot});
  });
  int64_t objects = 0;
  database.sql().query(
      "SELECT count(DISTINCT (of_robot, of_object)) FROM loci.identity WHERE home = $1 AND robot = $2",
      {unified.home, unified.robot}, [&](ResultRow row) { objects = integer_of(row[0]); });
  return objects;
}

}  // namespace loci::memory
