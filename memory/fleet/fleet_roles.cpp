#include "memory/fleet/fleet_roles.h"

#include <fmt/format.h>

namespace loci::memory {
namespace {

SqlParameters parameters_of(const FleetRole& role) {
  check_name({role.home, role.robot.value_or("reader")});
  return {role.role, role.home, role.robot.value_or("")};
}

}  // namespace

void grant_role(const FleetUrl& url, const FleetRole& role) {
  const SqlParameters parameters = parameters_of(role);
  FleetDatabase database(url);
  database.make_schema();
  database.check_schema();
  database.transaction(
      [&] { database.sql().query("SELECT loci.admit($1, $2, $3)", parameters, [](ResultRow) {}); });
}

void revoke_role(const FleetUrl& url, const FleetRole& role) {
  const SqlParameters parameters = parameters_of(role);
  FleetDatabase database(url);
  database.check_schema();
  bool had = false;
  database.transaction([&] {
    database.sql().query("SELECT loci.dismiss($1, $2, $3)", parameters,
                         [&](ResultRow row) { had = integer_of(row[0]) != 0; });
  });
  if (!had) throw database.error(fmt::format("role '{}' does not have these rights", role.role));
}

std::vector<std::string> homes_of(const FleetUrl& url, const std::string& robot) {
  std::vector<std::string> homes;
  FleetDatabase database(url);
  database.sql().query("SELECT home FROM loci.robot WHERE robot = $1 ORDER BY home", {robot},
                       [&](ResultRow row) { homes.push_back(text_of(row[0])); });
  return homes;
}

}  // namespace loci::memory
