#pragma once

#include "memory/belief/state.h"

namespace loci::memory::belief {

/// The belief as the first version wrote it (CBOR). Throws nlohmann::json::exception when the bytes are none.
BeliefState belief_state_of_version_1(const std::string& bytes);

}  // namespace loci::memory::belief
