#pragma once

#include <nlohmann/json_fwd.hpp>

namespace loci {

/// JSON with keys in the order in which they were written. Declared only: headers that name it in signatures
/// include this, who uses it includes mapping/base/text/json.h, which costs a second to compile.
using Json = nlohmann::ordered_json;

}  // namespace loci
