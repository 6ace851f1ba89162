#pragma once

#include <initializer_list>

#include "mapping/base/config.h"

namespace loci {

/// Refuses keys other than these before anything is read: a misspelt key is also a missing one, and the
/// misspelling is what people want to be told.
inline void refuse_unknown_keys(const Config& config, std::initializer_list<const char*> keys) {
  for (const char* key : keys) static_cast<void>(config.has(key));
  config.finish();
}

}  // namespace loci
