#pragma once

#include "memory/fleet/fleet_database.h"

namespace loci::memory {

/// The robots of a home whose memories the URL's role may read and whose pushes are complete, but one.
std::vector<std::string> robots_of_home(const FleetUrl& url, const std::string& home,
                                        const std::string& except);

/// After the merged memory of other robots was pushed as that of `unified`: writes which of its objects are
/// which of theirs, by the observations that both have (recording, frame and number), into loci.identity, in
/// the place of earlier rows. The number of objects of other robots.
int64_t write_identities(const FleetUrl& url, const RobotName& unified);

}  // namespace loci::memory
