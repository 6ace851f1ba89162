#pragma once

#include <string>
#include <vector>

#include "mapping/base/text/json_fwd.h"
#include "memory/store/store.h"

namespace loci::memory {

/// The features, as JSON objects, of the structures of a type that an annotation stored; empty where there
/// are none, and for rows of foreign files that are not what a writer would store.
std::vector<Json> features_of(const Store& store, const AnnotationRow& annotation, const std::string& type);

/// A feature that is a text; "" where there is none.
std::string text_feature(const Json& features, const char* name);

}  // namespace loci::memory
