#pragma once

#include <string>

#include "mapping/base/text/json_fwd.h"
#include "memory/identity/solution.h"

namespace loci::memory {

/// One identity problem in the JSON layout of docs/identity.md.
struct IdentityVector {
  IdentityProblem problem;
  IdentityOptions options;
};

/// Reads a problem. Error (invalid_shape, invalid_value) names the file and the entry. Without "gate" it is
/// solved without dropping anything.
IdentityVector identity_vector_from_json(const Json& json, const std::string& file);

/// The answer in the layout of the file's "expect".
Json to_json(const IdentitySolution& solution);

}  // namespace loci::memory
