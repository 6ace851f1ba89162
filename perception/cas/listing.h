#pragma once

#include "mapping/base/json_fwd.h"
#include "perception/cas/type_system.h"

namespace loci::perception::cas {

/// The declared types (not the built-in ones) with supertype, features, allowed values; for people.
std::string types_text(const TypeSystem& system);

/// The same for programs: {"types": n, "features": n, "type": [{"name", "supertype", "file", "line",
/// "description", "features": [{"name", "range", "element", "description", "inherited_from"}],
/// "allowed_values"}]}. Lists hold inherited features too; the counts those that were declared.
Json types_json(const TypeSystem& system);

}  // namespace loci::perception::cas
