#pragma once

#include "memory/fleet/fleet_database.h"

namespace loci::memory {

/// A role of the server, and the memory of a robot that it may read and push; or a home of which it may read
/// every memory and write none (`robot` unset).
struct FleetRole {
  std::string role = {};
  std::string home = {};
  std::optional<std::string> robot = {};
};

/// Gives the rights. Error unless the URL's role owns the schema (it is made when it is missing) and the role
/// exists.
void grant_role(const FleetUrl& url, const FleetRole& role);
/// Takes them back. Error when the role did not have them.
void revoke_role(const FleetUrl& url, const FleetRole& role);
/// The homes with a memory of a robot of this name, in alphabetical order.
std::vector<std::string> homes_of(const FleetUrl& url, const std::string& robot);

}  // namespace loci::memory
